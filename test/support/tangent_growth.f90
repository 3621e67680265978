!> Growth of perturbations by tangent vectors of one motion, made orthonormal again and again (Benettin, Galgani, Giorgilli and
!> Strelcyn, Meccanica 15, 1980): the judge of what is found in lanes.
module tangent_growth
    use mechanics
    use spintop_lyapunov, only: even_perturbation, scale_up, scales_of, span_perturbations
    implicit none
    private
    public :: tangent_exponents, tangent_exponent, tangent_factor

contains

    !> Exponents of perturbations, one per column, in the scales of the motion. With `across` they stay across the vertical.
    function tangent_exponents(body, start, t_end, pieces, directions, across) result(exponents)
        type(body_t), intent(in) :: body
        type(motion_t), intent(in) :: start
        real(dp), intent(in) :: t_end, directions(:, :)
        integer, intent(in) :: pieces
        logical, intent(in) :: across
        real(dp), dimension(size(directions, 2)) :: exponents, growth
        real(dp) :: columns(6, 1 + size(directions, 2)), unit(6)
        integer :: piece, status
        columns(:, 1) = euler_poisson_state(body, start)
        unit = scales_of(body, columns(:, 1), t_end)
        columns(:, 2:) = directions * spread(unit, 2, size(directions, 2))
        growth = 0
        call separate(.false.)
        do piece = 1, pieces
            call propagate_tangents(body, t_end / pieces, columns, status)
            if (.not. is_ok(status)) error stop 'tangent_growth: a perturbation was not followed'
            call separate(.true.)
        end do
        exponents = growth / t_end

    contains

        !> Makes the vectors orthonormal, each with respect to those before it.
        subroutine separate(counts)
            logical, intent(in) :: counts
            integer :: i, k
            do k = 2, size(columns, 2)
                if (across) call keep_across(columns(1:3, 1), columns(:, k))
                columns(:, k) = columns(:, k) / unit
                do i = 2, k - 1
                    columns(:, k) = columns(:, k) - dot_product(columns(:, i) / unit, columns(:, k)) * columns(:, i) / unit
                end do
                if (counts) growth(k - 1) = growth(k - 1) + log(norm2(columns(:, k)))
                columns(:, k) = columns(:, k) / norm2(columns(:, k)) * unit
            end do
        end subroutine separate

    end function tangent_exponents

    !> The exponent of a perturbation with equal components across the vertical.
    real(dp) function tangent_exponent(body, start, t_end, pieces) result(exponent)
        type(body_t), intent(in) :: body
        type(motion_t), intent(in) :: start
        real(dp), intent(in) :: t_end
        integer, intent(in) :: pieces
        real(dp) :: x(6), unit(6)
        x = euler_poisson_state(body, start)
        unit = scales_of(body, x, t_end)
        exponent = sum(tangent_exponents(body, start, t_end, pieces, &
                                         reshape(even_perturbation(x(1:3), unit) / unit, [6, 1]), .true.))
    end function tangent_exponent

    !> The largest factor by which a perturbation grows that keeps the length of the vertical.
    real(dp) function tangent_factor(body, start, t_end, pieces) result(factor)
        type(body_t), intent(in) :: body
        type(motion_t), intent(in) :: start
        real(dp), intent(in) :: t_end
        integer, intent(in) :: pieces
        real(dp) :: columns(6, 6), unit(6), scale, growth
        integer :: piece, k, status
        columns(:, 1) = euler_poisson_state(body, start)
        unit = scales_of(body, columns(:, 1), t_end)
        call span_perturbations(columns(1:3, 1), unit, columns(:, 2:))
        growth = 0
        do piece = 1, pieces
            call propagate_tangents(body, t_end / pieces, columns, status)
            if (.not. is_ok(status)) error stop 'tangent_growth: a perturbation was not followed'
            do k = 2, 6
                call keep_across(columns(1:3, 1), columns(:, k))
            end do
            scale = maxval(abs(columns(:, 2:)) / spread(unit, 2, 5))
            growth = growth + log(scale)
            columns(:, 2:) = columns(:, 2:) / scale
        end do
        call scale_up(columns(:, 2:) / spread(unit, 2, 5), growth, factor, status)
    end function tangent_factor

    !> Takes away what changes the length of the vertical.
    subroutine keep_across(vertical, vector)
        real(dp), intent(in) :: vertical(3)
        real(dp), intent(inout) :: vector(6)
        vector(1:3) = vector(1:3) - dot_product(vertical, vector(1:3)) / sum(vertical**2) * vertical
    end subroutine keep_across

end module tangent_growth
