!> The methods and formulations of the library, and which of them can be combined for a body.
program methods
    use spintop
    implicit none
    type(body_t) :: body
    type(method_info_t), allocatable :: known(:)
    type(formulation_info_t), allocatable :: forms(:)
    class(formulation_t), allocatable :: formulation
    class(stepper_t), allocatable :: stepper
    character(:), allocatable :: line
    integer :: i, k

    body%inertia = [0.875_dp, 0.875_dp, 0.25_dp]
    body%centre_of_mass(3) = sqrt(0.75_dp)
    allocate (known, source=method_infos())
    allocate (forms, source=formulation_infos())
    do i = 1, size(known)
        call create_stepper(trim(known(i)%name), stepper)
        if (.not. known(i)%adaptive) stepper%controls%steps = 100
        line = trim(known(i)%name) // ':'
        do k = 1, size(forms)
            call create_formulation(trim(forms(k)%name), formulation)
            if (can_run(stepper, formulation, body) == status_ok) line = line // ' ' // trim(forms(k)%name)
        end do
        print '(a)', line
    end do
end program methods
