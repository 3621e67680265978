! The version of SUNDIALS, and the kind of its indices. scripts/setup examines the .mod files, and adds the
! folder of this header if the compiler does not find SUNDIALS by itself.
#include <sundials/sundials_config.h>

!> The common part of SUNDIALS 6 and 7: the modules of its core under one name, and a context that does not
!> print.
module spintop_sundials
    use, intrinsic :: iso_c_binding, only: c_funloc, c_int, c_int32_t, c_int64_t, c_null_ptr, c_ptr
#if SUNDIALS_VERSION_MAJOR >= 7
#ifdef SPINTOP_MPI
    use mpi_f08, only: MPI_COMM_NULL
#else
    use fsundials_core_mod, only: SUN_COMM_NULL
#endif
    use fsundials_core_mod, only: &
        FN_VDestroy, FN_VGetArrayPointer, FSUNContext_ClearErrHandlers, FSUNContext_Create, FSUNContext_Free, &
        FSUNContext_SetLogger, FSUNLinSolFree, FSUNMatDestroy, FSUNNonlinSolFree, FSUNNonlinSolGetCurIter, &
        FSUNNonlinSolSetConvTestFn, N_Vector, SUN_NLS_CONTINUE, SUN_NLS_CONV_RECVR, &
        SUN_NLS_SUCCESS => SUN_SUCCESS, SUNLinearSolver, SUNMatrix, SUNNonlinearSolver
#else
    use farkode_arkstep_mod, only: FARKStepSetErrHandlerFn
    use fsundials_context_mod, only: FSUNContext_Create, FSUNContext_Free
    use fsundials_linearsolver_mod, only: FSUNLinSolFree, SUNLinearSolver
    use fsundials_matrix_mod, only: FSUNMatDestroy, SUNMatrix
    use fsundials_nonlinearsolver_mod, only: FSUNNonlinSolFree, FSUNNonlinSolGetCurIter, &
        FSUNNonlinSolSetConvTestFn, SUN_NLS_CONTINUE, SUN_NLS_CONV_RECVR, SUN_NLS_SUCCESS, SUNNonlinearSolver
    use fsundials_nvector_mod, only: FN_VDestroy, FN_VGetArrayPointer, N_Vector
#endif
    implicit none
    private
    public :: create_context, index_kind, silence
    public :: FN_VDestroy, FN_VGetArrayPointer, FSUNContext_Free, FSUNLinSolFree, FSUNMatDestroy, FSUNNonlinSolFree
    public :: FSUNNonlinSolGetCurIter, FSUNNonlinSolSetConvTestFn, SUN_NLS_CONTINUE, SUN_NLS_CONV_RECVR, SUN_NLS_SUCCESS
    public :: N_Vector, SUNLinearSolver, SUNMatrix, SUNNonlinearSolver

    !> Kind of the sizes of vectors and matrices.
#ifdef SUNDIALS_INT32_T
    integer, parameter :: index_kind = c_int32_t
#else
    integer, parameter :: index_kind = c_int64_t
#endif

contains

#if SUNDIALS_VERSION_MAJOR >= 7
    !> Makes a context for one process; negative on failure.
    integer(c_int) function create_context(context) result(flag)
        type(c_ptr), intent(inout) :: context !! the new context
        integer(c_int) :: communicator
        ! SUN_COMM_NULL of Fortran is 0, which is the handle of MPI_COMM_WORLD in Open MPI: all ranks would
        ! have to create and free their contexts together.
#ifdef SPINTOP_MPI
        communicator = MPI_COMM_NULL%MPI_VAL
#else
        communicator = SUN_COMM_NULL
#endif
        flag = FSUNContext_Create(communicator, context)
        if (flag >= 0) flag = FSUNContext_ClearErrHandlers(context)
        if (flag >= 0) flag = FSUNContext_SetLogger(context, c_null_ptr)
        if (flag > 0) flag = -flag
    end function create_context

    !> Nothing to do: the context does not print.
    integer(c_int) function silence(integrator) result(flag)
        type(c_ptr), intent(in) :: integrator !! memory of the integrator
        associate (unused => integrator)
        end associate
        flag = 0
    end function silence
#else
    !> Makes a context for one process; negative on failure.
    integer(c_int) function create_context(context) result(flag)
        type(c_ptr), intent(inout) :: context !! the new context
        flag = FSUNContext_Create(c_null_ptr, context)
    end function create_context

    !> Stops an integrator from printing to standard error.
    integer(c_int) function silence(integrator) result(flag)
        type(c_ptr), intent(in) :: integrator !! memory of the integrator
        flag = FARKStepSetErrHandlerFn(integrator, c_funloc(keep_silent), c_null_ptr)
    end function silence

    !> The callback that receives messages, and ignores them.
    subroutine keep_silent(code, module_name, function_name, message, data) bind(C, name='')
        integer(c_int), value :: code
        type(c_ptr), value :: module_name, function_name, message, data
    end subroutine keep_silent
#endif

end module spintop_sundials
