// All kernels, and their table, which is named KERNELS: included once for each level of the processor.

// Vectors wider than those of the processor are no arguments of functions that are called.
#pragma GCC diagnostic ignored "-Wpsabi"

#include <float.h>
#include <math.h>
#include <string.h>
#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include "vectors.h"

#include "one_body/top_series.h"

#include "binary_powers.h"

#include "one_body/series_terms.h"
#include "one_body/dop853_error.h"

#include "many_bodies/lane_products.h"
#include "many_bodies/lane_roots.h"
#include "many_bodies/lane_series.h"
#include "many_bodies/lane_steps.h"

#include "series/algebra_names.h"
#include "series/motions_of_level.h"

#include "closed_form/top_lanes.h"

#define PROCEDURE(name, ...) .name = name,
#define FUNCTION PROCEDURE
const struct kernels KERNELS = {
#include "kernel_list.h"
};
