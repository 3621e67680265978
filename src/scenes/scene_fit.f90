!> The group &fit of an input as plain data, with its rows of the parameter table.
module spintop_scene_fit
    use spintop_kinds, only: dp
    use spintop_parameters, only: leading_elements, parameter_table_t, unset
    use spintop_text, only: join
    implicit none
    private
    public :: fit_scene_t, describe_fit, most_unknown, loss_names, loss_huber

    !> Maximum number of sought parameters, and of columns of measurements.
    integer, parameter :: most_unknown = 16, most_columns = 16

    !> The losses of residuals (fit.loss), and the index of Huber's.
    character(*), parameter :: loss_names(2) = [character(7) :: 'squares', 'huber']
    integer, parameter :: loss_huber = 2

    !> The contents of the group.
    type :: fit_scene_t
        character(256) :: data = ''
        character(32) :: unknown(most_unknown) = ''
        character(32) :: columns(most_columns) = ''
        real(dp) :: sigma(most_columns) = unset
        character(32) :: loss = ''
        logical :: profile = .true.
    end type fit_scene_t

contains

    !> Adds the keys to the table of an input.
    subroutine describe_fit(scene, table)
        type(fit_scene_t), target, intent(inout) :: scene !! the group; it must exist as long as the table
        type(parameter_table_t), intent(inout) :: table !! the keys are added

        call table%add('fit.data', scene%data, what='CSV table of measurements: t, and columns of trajectories')
        call table%add('fit.unknown', scene%unknown, what='sought parameters; their values are where the search begins')
        call table%add('fit.columns', scene%columns, what='measured columns (all but t)')
        call table%add('fit.sigma', scene%sigma, '', '> 0', 'standard deviations of the measured columns, in their units (one ' // &
                       'that is common to all columns, from the residuals)', elements=leading_elements)
        call table%add('fit.loss', scene%loss, join(loss_names, '|'), 'least squares, or the robust loss of Huber (squares)')
        call table%add('fit.profile', scene%profile, 'compute profile intervals')
    end subroutine describe_fit

end module spintop_scene_fit
