!> The words of inputs, texts and tables that several suites use.
module texts_and_tables
    use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_accumulators, only: bins_around, bins_t, even_bins
    use spintop_checksum
    use spintop_process
    use spintop_diagnostics
    use spintop_errors
    use spintop_files
    use spintop_kinds
    use spintop_number_slot
    use spintop_parameter_print
    use spintop_parameters
    use spintop_problems
    use spintop_random
    use spintop_row_block
    use spintop_row_table
    use spintop_sample_design
    use spintop_state_stream
    use spintop_status
    use spintop_table_column
    use spintop_table_end
    use spintop_journaled_table
    use spintop_table_head
    use spintop_text
    use spintop_thread_team, only: none_left, retry_later, row_queue_t
    use spintop_units
    implicit none
    public
end module texts_and_tables
