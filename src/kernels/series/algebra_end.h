// Ends what an algebra has set, so that the next one may set it.

#undef NAME
#undef element
#undef stride
#undef at_once
#undef room
#undef components
#undef attitude_room
#undef has_registers
#undef most_turned
#undef is_many
#undef pairs_for
