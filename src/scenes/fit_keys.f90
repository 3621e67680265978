!> The groups &fit and &sensor of an input as plain data, with their rows of the parameter table.
module spintop_fit_keys
    use spintop_kinds, only: dp
    use spintop_losses, only: loss_names
    use spintop_parameters, only: any_elements, is_set, leading_elements, one_per_group, parameter_table_t, unset
    use spintop_scene_words, only: key_length
    use spintop_text, only: join
    implicit none
    private
    public :: fit_scene_t, sensors_t, describe_fit, most_unknown, most_columns

    !> Maximum number of sought parameters, and of columns of measurements.
    integer, parameter :: most_unknown = 16, most_columns = 16

    !> The groups &sensor: what is known of a measured column, one element each.
    type :: sensors_t
        character(key_length) :: column(most_columns) = ''
        real(dp) :: sigma(most_columns) = unset
        !> The reading is the offset and the scale times the quantity.
        real(dp) :: offset(most_columns) = unset
        real(dp) :: scale(most_columns) = unset
    contains
        procedure :: place_of
    end type sensors_t

    !> The contents of the group &fit.
    type :: fit_scene_t
        character(256) :: data = ''
        character(key_length) :: unknown(most_unknown) = ''
        !> Where the sought parameters are searched, if the search is to be global.
        real(dp) :: from(most_unknown) = unset, to(most_unknown) = unset
        character(key_length) :: columns(most_columns) = ''
        real(dp) :: sigma(most_columns) = unset
        character(key_length) :: wrapped(most_columns) = ''
        character(32) :: loss = ''
        logical :: profile = .true., windows = .true.
        integer :: searches = 12
        real(dp) :: time_offset = unset, averaged = unset, mounting(3) = unset
        type(sensors_t) :: sensors
    contains
        procedure :: set_defaults
    end type fit_scene_t

contains

    !> Adds the keys to the table of an input.
    subroutine describe_fit(scene, table)
        type(fit_scene_t), target, intent(inout) :: scene !! the group; it must exist as long as the table
        type(parameter_table_t), intent(inout) :: table !! the keys are added

        call table%add('fit.data', scene%data, what='CSV table of measurements: t, and columns of trajectories')
        call table%add('fit.unknown', scene%unknown, what='sought parameters; their values are where the search begins')
        call table%add('fit.from', scene%from, 'of fit.unknown', '', &
                       'lower ends of the ranges in which the parameters are sought, in their ' // &
                       'units (near their values)', elements=any_elements)
        call table%add('fit.to', scene%to, 'of fit.unknown', '', 'upper ends of these ranges', elements=any_elements)
        call table%add('fit.columns', scene%columns, what='measured columns (all but t)')
        call table%add('fit.sigma', scene%sigma, 'of fit.columns', '> 0', &
                       'standard deviations of the measured columns, in their units (one ' // &
                       'that is common to all columns, from the residuals)', elements=leading_elements)
        call table%add('fit.wrapped', scene%wrapped, what='measured angles that are known but for whole turns')
        call table%add('fit.loss', scene%loss, join(loss_names, '|'), 'least squares, or a robust loss (squares)')
        call table%add('fit.profile', scene%profile, 'compute profile intervals')
        call table%add('fit.windows', scene%windows, 'begin with the first rows, and double their span step by step')
        call table%add('fit.searches', scene%searches, '', '>= 1', 'starts of the search at most, where the first is poor')
        call table%add('fit.time_offset', scene%time_offset, 's', '', 'time of the motion at t = 0 of the table (0)')
        call table%add('fit.averaged', scene%averaged, 's', '>= 0', 'width of the interval of which a reading is the mean (0)')
        call table%add('fit.mounting', scene%mounting, 'rad', '', &
                       'rotation vector from body axes to those of the sensor of ' // &
                       'omega1 to omega3 and accelerometer1 to accelerometer3 (0)')
        associate (sensors => scene%sensors)
            call table%add('sensor.column', sensors%column, what='measured column; one group for each sensor', &
                           elements=one_per_group)
            call table%add('sensor.sigma', sensors%sigma, 'of sensor.column', '> 0', &
                           'standard deviation of its readings, in their unit', elements=one_per_group)
            call table%add('sensor.offset', sensors%offset, 'of sensor.column', '', 'reading where the quantity is 0 (0)', &
                           elements=one_per_group)
            call table%add('sensor.scale', sensors%scale, '', '', 'change of the reading with the quantity (1)', &
                           elements=one_per_group)
        end associate
    end subroutine describe_fit

    !> The number of the group of a column, which is taken if there is none yet; 0 if there are too many.
    integer function place_of(self, column) result(place)
        class(sensors_t), intent(inout) :: self
        character(*), intent(in) :: column !! name of a measured column
        do place = 1, size(self%column)
            if (self%column(place) == column .or. self%column(place) == '') exit
        end do
        if (place > size(self%column)) place = 0
        if (place > 0) self%column(place) = column
    end function place_of

    !> Sets what is not given, but for standard deviations and ranges.
    subroutine set_defaults(self)
        class(fit_scene_t), intent(inout) :: self
        if (.not. is_set(self%time_offset)) self%time_offset = 0
        if (.not. is_set(self%averaged)) self%averaged = 0
        where (.not. is_set(self%mounting)) self%mounting = 0
        where (.not. is_set(self%sensors%offset)) self%sensors%offset = 0
        where (.not. is_set(self%sensors%scale)) self%sensors%scale = 1
    end subroutine set_defaults

end module spintop_fit_keys
