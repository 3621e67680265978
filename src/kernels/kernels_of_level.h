// All kernels, and their table, which is named KERNELS: included once for each level of the processor.

// Vectors wider than those of the processor are no arguments of functions that are called.
#pragma GCC diagnostic ignored "-Wpsabi"

#include <float.h>
#include <math.h>
#include <string.h>

#include "vectors.h"

#include "body_vectors.h"
#include "shares.h"
#include "body_start.h"

#include "body_series.h"
#include "body_stages.h"
#include "effects_series.h"
#include "effects_stages.h"
#include "top_series.h"

#include "binary_powers.h"

#include "series_terms.h"
#include "stage_error.h"

#include "lane_vectors.h"

#include "lane_effects.h"
#include "lane_products.h"
#include "lane_roots.h"
#include "lane_series.h"
#include "lane_work.h"

#define PROCEDURE(name, ...) .name = name,
#define FUNCTION PROCEDURE
const struct kernels KERNELS = {
#include "kernel_list.h"
};
