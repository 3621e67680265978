!> Whether a fit explains the measurements: the sum of squares against the standard deviations, residuals that are no noise,
!> and rows that stand out.
module spintop_fit_judgement
    use spintop_fit_data, only: measurements_t
    use spintop_goodness, only: find_correlation, find_drift, find_period, von_neumann_ratio
    use spintop_kinds, only: dp
    use spintop_least_squares, only: minimum_t
    use spintop_losses, only: loss_t
    use spintop_probability, only: chi_square_tail
    use spintop_robust, only: robust_deviation
    use spintop_summary, only: rounded
    use spintop_text, only: append, string_t, to_text
    implicit none
    private
    public :: judgement_t, judge

    !> A row stands out by so many standard deviations, and more where few rows give them. Rows that stand out have spoiled least
    !> squares where this part of the sum of squares is theirs.
    real(dp), parameter :: standing_out = 6, spoiling = 0.2_dp
    !> Residuals are no noise where the ratio of von Neumann is so far from its mean, 2, and this number of its standard
    !> deviations.
    real(dp), parameter :: far = 1, significant = 4
    !> Nor where far neighbours are correlated by so much, and not by chance. Residuals are cut at so many standard deviations.
    real(dp), parameter :: correlated = 0.04_dp, cut = 3
    !> The sum of squares is too large where it is so many times what is expected and has at most this probability; the
    !> probability below which standard deviations are doubted.
    real(dp), parameter :: too_large = 1.1_dp, impossible = 1.0e-6_dp, doubtful = 1.0e-3_dp
    !> A period or a drift is named that noise has with this probability, or that is so many standard errors.
    real(dp), parameter :: seldom = 1.0e-4_dp, clear_drift = 5

    !> What was found.
    type :: judgement_t
        !> Whether the fit does not explain the measurements, and what stands out then.
        logical :: is_poor = .false.
        character(:), allocatable :: reason
        !> What is odd about the residuals, a sentence each.
        type(string_t), allocatable :: warnings(:)
        !> The sum of squares and its degrees of freedom, where standard deviations are known, and its probability.
        real(dp) :: chi2 = 0, probability = 1
        integer :: freedom = 0
    end type judgement_t

contains

    !> Judges a minimum.
    subroutine judge(measured, differences, minimum, loss, is_noisy, with_words, judgement)
        type(measurements_t), intent(in) :: measured !! the measurements
        real(dp), intent(in) :: differences(:, :) !! measured less fitted: columns, leading rows
        type(minimum_t), intent(in) :: minimum !! the parameters, and the residuals in units of their deviations
        type(loss_t), intent(in) :: loss !! the loss that is least there
        logical, intent(in) :: is_noisy !! whether the residuals are larger than the errors of the motion
        logical, intent(in) :: with_words !! whether reason and warnings are wanted
        type(judgement_t), intent(out) :: judgement !! what was found
        real(dp), allocatable :: residuals(:), t(:)
        integer, allocatable :: rows(:)
        integer :: i, k

        allocate (judgement%warnings(0))
        judgement%reason = ''
        if (measured%knows_sigma) call judge_size(minimum, loss, with_words, judgement)
        if (.not. is_noisy) return
        do i = 1, size(differences, 1)
            rows = pack([(k, k=1, size(differences, 2))], measured%is_there(i, :size(differences, 2)))
            t = measured%t(rows)
            residuals = differences(i, rows)
            if (measured%knows_sigma) residuals = residuals / measured%sigma(i, rows)
            call judge_order(trim(measured%columns(i)%name), t, residuals, with_words, judgement)
            call judge_outliers(trim(measured%columns(i)%name), t, rows, residuals, size(minimum%x), loss, with_words, &
                                judgement)
        end do
    end subroutine judge

    !> Adds what stands out to the reason of a poor fit.
    subroutine add_reason(judgement, text)
        type(judgement_t), intent(inout) :: judgement
        character(*), intent(in) :: text
        judgement%is_poor = .true.
        if (judgement%reason /= '') judgement%reason = judgement%reason // '; '
        judgement%reason = judgement%reason // text
    end subroutine add_reason

    !> The sum of squares against the known standard deviations. With a robust loss it is that of the deviation by the median.
    subroutine judge_size(minimum, loss, with_words, judgement)
        type(minimum_t), intent(in) :: minimum
        type(loss_t), intent(in) :: loss
        logical, intent(in) :: with_words
        type(judgement_t), intent(inout) :: judgement
        real(dp), parameter :: efficiency = 0.37_dp ! of a deviation by the median
        real(dp) :: per_freedom, share
        character(:), allocatable :: what

        share = 1
        associate (m => size(minimum%residuals), n => size(minimum%x))
            judgement%freedom = max(m - n, 1)
            judgement%chi2 = minimum%sum_of_squares
            if (loss%is_robust()) then
                judgement%chi2 = judgement%freedom * robust_deviation(minimum%residuals, n)**2
                share = efficiency
            end if
        end associate
        per_freedom = judgement%chi2 / judgement%freedom
        judgement%probability = chi_square_tail(share * judgement%chi2, max(nint(share * judgement%freedom), 1))
        judgement%is_poor = per_freedom > too_large .and. judgement%probability < impossible
        if (.not. with_words) return
        what = 'chi2 is ' // rounded(per_freedom, 3) // ' per degree of freedom'
        if (judgement%is_poor) then
            call add_reason(judgement, what)
        else if (judgement%probability < doubtful .and. per_freedom > 1) then
            call append(judgement%warnings, what // ', which has a probability of ' // rounded(judgement%probability, 2) // &
                        ': the standard deviations are larger than sigma by a factor of ' // rounded(sqrt(per_freedom), 3))
        else if (1 - judgement%probability < doubtful) then
            call append(judgement%warnings, what // ': the standard deviations are smaller than sigma by a factor of ' // &
                        rounded(sqrt(per_freedom), 3))
        end if
    end subroutine judge_size

    !> Residuals that are no noise: each like the one before, or minus that, or like others far from it.
    subroutine judge_order(name, t, residuals, with_words, judgement)
        character(*), intent(in) :: name
        real(dp), intent(in) :: t(:), residuals(:)
        logical, intent(in) :: with_words
        type(judgement_t), intent(inout) :: judgement
        real(dp) :: ratio, strength, chance, period, amplitude, probability, drift, significance
        character(:), allocatable :: text

        ratio = von_neumann_ratio(residuals)
        call find_correlation(residuals, cut * robust_deviation(residuals, 0), strength, chance)
        text = ''
        if (abs(ratio - 2) > max(far, significant * 2 / sqrt(real(size(residuals), dp)))) then
            text = 'each is like ' // trim(merge('the one before      ', 'minus the one before', ratio < 2)) // &
                   ' (ratio of von Neumann ' // rounded(ratio, 3) // ', 2 for noise)'
        else if (strength > correlated .and. chance < impossible) then
            text = 'they repeat themselves (far neighbours have a correlation of ' // rounded(strength, 2) // ')'
        end if
        if (text == '') return
        judgement%is_poor = .true.
        if (.not. with_words) return
        text = 'the residuals of ' // name // ' are no noise: ' // text
        call find_period(t, residuals, period, amplitude, probability)
        call find_drift(t, residuals, drift, significance)
        if (probability < seldom) text = text // ', with a period of ' // rounded(period, 3) // ' s'
        if (significance > clear_drift) text = text // ', with a drift'
        call add_reason(judgement, text)
    end subroutine judge_order

    !> The rows of a column that stand out of the others.
    subroutine judge_outliers(name, t, rows, residuals, parameters, loss, with_words, judgement)
        character(*), intent(in) :: name
        real(dp), intent(in) :: t(:), residuals(:)
        integer, intent(in) :: rows(:), parameters
        type(loss_t), intent(in) :: loss
        logical, intent(in) :: with_words
        type(judgement_t), intent(inout) :: judgement
        character(:), allocatable :: text, hint
        real(dp) :: deviation, limit
        integer :: i, more
        logical :: is_spoiled

        if (size(t) <= parameters + 3) return
        deviation = robust_deviation(residuals, parameters)
        limit = standing_out * (1 + 5.0_dp / (size(t) - parameters)) * deviation
        i = maxloc(abs(residuals), dim=1)
        if (.not. (abs(residuals(i)) > limit .and. deviation > 0)) return
        is_spoiled = .not. loss%is_robust() .and. sum(pack(residuals, abs(residuals) > limit)**2) > spoiling * sum(residuals**2)
        judgement%is_poor = judgement%is_poor .or. is_spoiled
        if (.not. with_words) return
        more = count(abs(residuals) > limit) - 1
        text = name // ' in row ' // to_text(rows(i)) // ', t = ' // to_text(t(i)) // ' s, is ' // &
               rounded(abs(residuals(i)) / deviation, 3) // ' standard deviations from the motion'
        if (more > 0) then
            text = text // ', and ' // to_text(more) // trim(merge(' more row stands', ' more rows stand', more == 1)) // ' out'
        end if
        hint = "; remove what is wrong, or use loss = 'huber' or 'tukey'"
        if (loss%is_robust()) hint = ''
        if (is_spoiled) then
            call add_reason(judgement, text)
        else
            call append(judgement%warnings, text // hint)
        end if
    end subroutine judge_outliers

end module spintop_fit_judgement
