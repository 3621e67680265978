!> The items of the registries as they are listed. An item is a line of text (its name, a second column, and what it is)
!> and an object of JSON, for scripts, where what does not exist is null.
module spintop_listed_items
    use spintop_json, only: json_t
    use spintop_text, only: append, string_t
    implicit none
    private
    public :: listing_t

    !> Lists of items, as text and as members of a JSON object.
    type :: listing_t
        type(string_t), allocatable :: text(:)
        type(json_t) :: json
    contains
        procedure :: add_line
        procedure :: begin_item
        procedure :: end_item
    end type listing_t

contains

    !> Adds a line of text: a name, a second column if it is not blank, and a meaning.
    subroutine add_line(self, name, what, second)
        class(listing_t), intent(inout) :: self
        character(*), intent(in) :: name !! the first column
        character(*), intent(in) :: what !! the meaning
        character(*), intent(in), optional :: second !! the second column
        character(30) :: first_column
        character(24) :: second_column
        first_column = name
        second_column = ''
        if (present(second)) second_column = second
        if (second_column == '') then
            call append(self%text, '  ' // first_column // trim(what))
        else
            call append(self%text, '  ' // first_column // second_column // trim(what))
        end if
    end subroutine add_line

    !> Adds the line of an item, and opens its object with its name. Its other members follow.
    subroutine begin_item(self, name, what, second)
        class(listing_t), intent(inout) :: self
        character(*), intent(in) :: name !! the first column
        character(*), intent(in) :: what !! the meaning
        character(*), intent(in), optional :: second !! the second column
        call self%add_line(name, what, second)
        call self%json%open_object()
        call self%json%add('name', name)
    end subroutine begin_item

    !> Adds the description of an item as the last member of its object.
    subroutine end_item(self, what)
        class(listing_t), intent(inout) :: self
        character(*), intent(in) :: what !! the description
        call self%json%add('description', what)
        call self%json%close()
    end subroutine end_item

end module spintop_listed_items
