!> The tested words of mechanics, and what suites have for them.
module mechanics
    use tested
    use library_tables
    use observers
    use random_stream
    use runs
    use symmetric_cases
    implicit none
    public
end module mechanics
