!> Scenes of catalogues: their settings are those of an input, written in one text.
module spintop_scene_of_settings
    use spintop_diagnostics, only: diagnostics_t
    use spintop_errors, only: error_t
    use spintop_overrides, only: read_override
    use spintop_parameters, only: parameter_table_t
    use spintop_scene_keys, only: scene_t, describe_scene
    use spintop_text, only: split, string_t
    implicit none
    private
    public :: make_scene_of_settings

contains

    !> The scene of some settings, `group.key=value`, separated by semicolons.
    subroutine make_scene_of_settings(settings, scene, error)
        character(*), intent(in) :: settings !! the settings
        type(scene_t), target, intent(out) :: scene !! the scene
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(parameter_table_t) :: table
        type(diagnostics_t) :: diagnostics
        type(string_t), allocatable :: list(:)
        integer :: i

        call describe_scene(scene, table)
        call split(trim(settings), ';', list)
        do i = 1, size(list)
            call read_override(list(i)%text, table, diagnostics)
        end do
        call diagnostics%raise(error)
    end subroutine make_scene_of_settings

end module spintop_scene_of_settings
