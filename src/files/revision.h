#define SPINTOP_REVISION "12beec9e9e9e"
