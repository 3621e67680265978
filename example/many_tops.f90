!> Many symmetric tops in closed form, computed together: how far each falls, released at rest.
program many_tops
    use spintop
    implicit none
    type(exact_block_t), allocatable :: block
    integer :: i

    allocate (block)
    block%n = 400
    associate (n => block%n)
        block%inertia1(:n) = 0.875_dp       ! kg m^2, about the fixed point
        block%inertia3(:n) = 0.25_dp
        block%mgl(:n) = 9.81_dp * sqrt(0.75_dp) ! N m
        block%theta(:n) = 0.5_dp
        block%phi_rate(:n) = 0
        block%theta_rate(:n) = 0
        block%omega3(:n) = [(0.1_dp * i, i=1, n)]
        call compute_block(block, wants_end=.false., wants_period=.false.)
        print '(i0, a)', count(block%status(:n) == status_ok), ' tops'
        do i = n / 8, n, n / 8
            print '(a, f5.1, 2(a, f12.9), a)', 'spin', block%omega3(i), ' rad/s: theta up to', block%theta_max(i), &
                ' rad in', block%period(i), ' s'
        end do
    end associate
end program many_tops
