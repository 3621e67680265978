!> What the sources use of the Fortran modules of SUNDIALS, declared and not defined: for scripts/lint, where a
!> second compiler checks the sources that cannot read the .mod files of the first.
module sundials_core_declared
    use, intrinsic :: iso_c_binding, only: c_double, c_int, c_int32_t, c_ptr
    implicit none
    public

    type, bind(C) :: N_Vector
        type(c_ptr) :: content
    end type N_Vector
    type, bind(C) :: SUNMatrix
        type(c_ptr) :: content
    end type SUNMatrix
    type, bind(C) :: SUNLinearSolver
        type(c_ptr) :: content
    end type SUNLinearSolver
    type, bind(C) :: SUNNonlinearSolver
        type(c_ptr) :: content
    end type SUNNonlinearSolver

    integer(c_int), parameter :: SUN_COMM_NULL = 0
    integer(c_int), parameter :: SUN_SUCCESS = 0, SUN_NLS_CONTINUE = 901, SUN_NLS_CONV_RECVR = 902
    integer(c_int), external :: FSUNContext_Create, FSUNContext_Free, FSUNContext_ClearErrHandlers, &
        FSUNContext_SetLogger, FSUNLinSolFree, FSUNNonlinSolFree, FSUNNonlinSolGetCurIter, FSUNNonlinSolSetConvTestFn
    external :: FSUNMatDestroy, FN_VDestroy

    interface
        function FN_VMake_Serial(length, values, context) result(vector)
            import :: N_Vector, c_double, c_int32_t, c_ptr
            integer(c_int32_t), intent(in) :: length
            real(c_double), intent(inout) :: values(*)
            type(c_ptr) :: context
            type(N_Vector), pointer :: vector
        end function FN_VMake_Serial
        function FN_VGetArrayPointer(vector) result(values)
            import :: N_Vector, c_double
            type(N_Vector), intent(inout) :: vector
            real(c_double), pointer :: values(:)
        end function FN_VGetArrayPointer
        function FSUNDenseMatrix(rows, columns, context) result(matrix)
            import :: SUNMatrix, c_int32_t, c_ptr
            integer(c_int32_t), intent(in) :: rows, columns
            type(c_ptr) :: context
            type(SUNMatrix), pointer :: matrix
        end function FSUNDenseMatrix
        function FSUNLinSol_Dense(vector, matrix, context) result(solver)
            import :: N_Vector, SUNLinearSolver, SUNMatrix, c_ptr
            type(N_Vector), intent(inout) :: vector
            type(SUNMatrix), intent(inout) :: matrix
            type(c_ptr) :: context
            type(SUNLinearSolver), pointer :: solver
        end function FSUNLinSol_Dense
        function FSUNNonlinSol_FixedPoint(vector, vectors, context) result(solver)
            import :: N_Vector, SUNNonlinearSolver, c_int, c_ptr
            type(N_Vector), intent(inout) :: vector
            integer(c_int), intent(in) :: vectors
            type(c_ptr) :: context
            type(SUNNonlinearSolver), pointer :: solver
        end function FSUNNonlinSol_FixedPoint
        function FSUNNonlinSol_Newton(vector, context) result(solver)
            import :: N_Vector, SUNNonlinearSolver, c_ptr
            type(N_Vector), intent(inout) :: vector
            type(c_ptr) :: context
            type(SUNNonlinearSolver), pointer :: solver
        end function FSUNNonlinSol_Newton
    end interface
end module sundials_core_declared

module fsundials_core_mod
    use sundials_core_declared
end module fsundials_core_mod

module fnvector_serial_mod
    use sundials_core_declared, only: FN_VMake_Serial
end module fnvector_serial_mod

module fsunmatrix_dense_mod
    use sundials_core_declared, only: FSUNDenseMatrix
end module fsunmatrix_dense_mod

module fsunlinsol_dense_mod
    use sundials_core_declared, only: FSUNLinSol_Dense
end module fsunlinsol_dense_mod

module fsunnonlinsol_fixedpoint_mod
    use sundials_core_declared, only: FSUNNonlinSol_FixedPoint
end module fsunnonlinsol_fixedpoint_mod

module fsunnonlinsol_newton_mod
    use sundials_core_declared, only: FSUNNonlinSol_Newton
end module fsunnonlinsol_newton_mod
