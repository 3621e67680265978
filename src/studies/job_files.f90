!> The files of a job: their names, and that none of them replaces a file that is read, or that another job writes.
module spintop_job_files
    use spintop_errors, only: error_t, input_error
    use spintop_files, only: file_exists, is_same_file, path_from
    use spintop_fit_table, only: residual_path
    use spintop_job, only: job_t
    use spintop_options, only: options_t
    use spintop_scene_words, only: reference_names
    use spintop_statistics_csv, only: path_beside
    use spintop_table_file, only: stem_of
    use spintop_own_butcher_tables, only: path_of_table
    use spintop_text, only: escaped, string_t
    implicit none
    private
    public :: name_job, name_outputs, refuse_overwriting, tables_written

    !> Paths of files of a job.
    type :: files_t
        integer :: n = 0
        type(string_t) :: path(80)
    contains
        procedure :: add
    end type files_t

contains

    !> Names a job after its input.
    subroutine name_job(job)
        type(job_t), intent(inout) :: job !! the job, with the path of its input
        integer :: dot
        job%name = job%input%path(index(job%input%path, '/', back=.true.) + 1:)
        dot = index(job%name, '.', back=.true.)
        if (dot > 1) job%name = job%name(:dot - 1)
    end subroutine name_job

    !> Sets the names of the files that a job writes.
    subroutine name_outputs(options, job)
        type(options_t), intent(in) :: options !! options of the command line
        type(job_t), intent(inout) :: job !! the job, named after its input
        character(6) :: ending
        if (job%input%scene%file /= '') job%name = stem_of(trim(job%input%scene%file))
        associate (stem => options%output // '/' // job%name // options%shard%suffix())
            ending = merge('.nc ', '.csv', job%input%scene%format == 'netcdf')
            job%files%table = stem // trim(ending)
            job%files%statistics = ''
            if (job%statistics%is_wanted) then
                if (options%shard%is_part()) ending = '.state'
                job%files%statistics = stem // '.statistics' // trim(ending)
            end if
            if (.not. job%keeps_rows()) then
                job%files%table = job%files%statistics
                job%files%statistics = ''
            end if
            job%files%log = stem // '.log'
            job%files%events = ''
            if (any(job%events%is_listed)) job%files%events = stem // '.events.csv'
        end associate
    end subroutine name_outputs

    !> Returns an error if a job would replace a file that another one writes, or either of them one that is read.
    subroutine refuse_overwriting(job, other, is_other, error)
        type(job_t), intent(in) :: job, other !! the jobs
        logical, intent(in) :: is_other !! whether they are two
        type(error_t), allocatable, intent(inout) :: error !! not allocated if all is well
        type(files_t) :: written, theirs
        integer :: i, k

        written = files_written(job)
        theirs = files_written(other)
        do i = 1, written%n
            do k = 1, theirs%n
                if (.not. is_other .or. written%path(i)%text /= theirs%path(k)%text) cycle
                call refuse(job, written%path(i)%text, 'is also that of ' // escaped(other%input%path))
                return
            end do
        end do
        call compare(job, written, files_read(other))
        if (.not. allocated(error)) call compare(other, theirs, files_read(job))

    contains

        !> Refuses to replace what is read.
        subroutine compare(writer, files, sources)
            type(job_t), intent(in) :: writer
            type(files_t), intent(in) :: files, sources
            integer :: i, k
            do i = 1, files%n
                do k = 1, sources%n
                    if (allocated(error)) return
                    associate (file => files%path(i)%text, source => sources%path(k)%text)
                        if (.not. is_same_file(file, source)) cycle
                        call refuse(writer, file, 'would replace the file that is read as ' // escaped(source))
                    end associate
                end do
            end do
        end subroutine compare

        !> Makes the error.
        subroutine refuse(writer, file, what)
            type(job_t), intent(in) :: writer
            character(*), intent(in) :: file, what
            error = input_error(escaped(writer%input%path) // ': error: its table ' // escaped(file) // ' ' // what // &
                                '; set output.file, or name another folder with --output')
        end subroutine refuse

    end subroutine refuse_overwriting

    !> The names of the tables of a job that was run, each with a null character behind it.
    function tables_written(job) result(names)
        type(job_t), intent(in) :: job !! the job
        character(:), allocatable :: names
        type(files_t) :: files
        integer :: i
        names = ''
        files = files_written(job)
        do i = 1, files%n
            if (files%path(i)%text == job%files%log .or. .not. file_exists(files%path(i)%text)) cycle
            names = names // files%path(i)%text // achar(0)
        end do
    end function tables_written

    !> The files that a job may write.
    type(files_t) function files_written(job) result(files)
        type(job_t), intent(in) :: job
        character(:), allocatable :: statistics

        call files%add(job%files%table)
        if (job%axes%cases > 0) call files%add(job%files%log)
        if (job%files%events /= '') call files%add(job%files%events)
        if (job%input%scene%fit%data /= '') call files%add(residual_path(job%files%table))
        if (.not. job%statistics%is_wanted) return
        statistics = job%files%table
        if (job%files%statistics /= '') statistics = job%files%statistics
        call files%add(statistics)
        call files%add(path_beside(statistics, 'histogram'))
        call files%add(path_beside(statistics, 'indices'))
    end function files_written

    !> The files that a job reads.
    type(files_t) function files_read(job) result(files)
        type(job_t), intent(in) :: job
        integer :: i
        associate (scene => job%input%scene)
            call files%add(job%input%path)
            if (scene%sweep_table /= '') call files%add(path_from(job%input%path, scene%sweep_table))
            if (scene%effects%friction_table /= '') call files%add(path_from(job%input%path, scene%effects%friction_table))
            if (scene%effects%torque_table /= '') call files%add(path_from(job%input%path, scene%effects%torque_table))
            do i = 1, size(scene%tableaus)
                call files%add(path_from(job%input%path, path_of_table(scene%tableaus(i)%key)))
            end do
            if (scene%fit%data /= '') call files%add(path_from(job%input%path, scene%fit%data))
            if (all(reference_names /= scene%precision_reference)) then
                call files%add(path_from(job%input%path, scene%precision_reference))
            end if
        end associate
    end function files_read

    !> Adds a path.
    subroutine add(self, path)
        class(files_t), intent(inout) :: self
        character(*), intent(in) :: path !! the path
        self%n = self%n + 1
        self%path(self%n)%text = path
    end subroutine add

end module spintop_job_files
