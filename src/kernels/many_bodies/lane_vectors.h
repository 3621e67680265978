// Vectors of lanes.

// A row, which may lie anywhere.
inlined vector get(const double *rows_of_lanes, int row) {
    vector value;
    memcpy(&value, rows_of_lanes + lanes * row, sizeof value);
    return value;
}

inlined void put(double *rows_of_lanes, int row, vector value) { memcpy(rows_of_lanes + lanes * row, &value, sizeof value); }
