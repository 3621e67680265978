!> The methods of Butcher tables that a user gives.
module spintop_tableau_method
    use spintop_arkode, only: arkode_t
    use spintop_butcher, only: max_stages
    use spintop_runge_kutta, only: runge_kutta_t
    use spintop_stepper, only: method_info_t, stepper_t
    use spintop_tableau, only: tableau_t
    use spintop_text, only: to_text
    implicit none
    private
    public :: tableau_info, create_tableau_stepper

contains

    !> Properties of the method of a table.
    function tableau_info(tableau) result(info)
        type(tableau_t), intent(in) :: tableau !! a table without a problem
        type(method_info_t) :: info
        character(:), allocatable :: orders
        info%name = tableau%name
        info%implicit = .not. tableau%is_explicit()
        info%order = tableau%order
        info%adaptive = tableau%embedded_order > 0 .and. tableau%is_triangular()
        info%fixed_step = .true.
        info%caught_by_reset = tableau%order == 1
        info%family = 'own table'
        orders = to_text(tableau%order)
        if (tableau%embedded_order > 0) orders = orders // '(' // to_text(tableau%embedded_order) // ')'
        info%what = trim(merge('implicit', 'explicit', info%implicit)) // ' Runge-Kutta method of order ' // orders // &
                    ' with ' // to_text(tableau%stages) // ' stages, from a file'
    end function tableau_info

    !> The method of a table: an explicit one with a fixed step size, one whose stages depend on each other, or else that of
    !> ARKODE, which has step control and stages that depend on themselves.
    subroutine create_tableau_stepper(tableau, stepper, problem)
        type(tableau_t), intent(in) :: tableau !! a table without a problem
        class(stepper_t), allocatable, intent(out) :: stepper !! not allocated if there is no such method
        character(:), allocatable, intent(out) :: problem !! why there is none; ''
        type(runge_kutta_t), allocatable :: explicit
        type(arkode_t), allocatable :: arkode

        problem = ''
        associate (n => tableau%stages)
            if (.not. tableau%is_triangular()) then
                problem = 'stages depend on later ones; expected a table whose stages depend on those before them and on &
                    &themselves only (of the others there are gauss_4, gauss_6 and gauss_8)'
                return
            else if (tableau%is_explicit() .and. tableau%embedded_order == 0 .and. n <= max_stages) then
                allocate (explicit)
                explicit%table%stages = n
                explicit%table%order = tableau%order
                explicit%table%a(:n, :n) = transpose(tableau%a(:n, :n))
                explicit%table%b(:n) = tableau%b(:n)
                explicit%table%c(:n) = tableau%c(:n)
                call move_alloc(explicit, stepper)
            else
                allocate (arkode)
                allocate (arkode%own, source=tableau)
                call move_alloc(arkode, stepper)
            end if
        end associate
        stepper%info = tableau_info(tableau)
    end subroutine create_tableau_stepper

end module spintop_tableau_method
