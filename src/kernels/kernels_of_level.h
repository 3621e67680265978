// All kernels, and their table, which is named KERNELS: included once for each level of the processor.

// Vectors wider than those of the processor are no arguments of functions that are called.
#pragma GCC diagnostic ignored "-Wpsabi"

#include <float.h>
#include <math.h>
#include <string.h>

#include "vectors.h"

#include "body_vectors.h"
#include "body_start.h"

#include "body_series.h"
#include "body_stages.h"
#include "effects_series.h"
#include "effects_stages.h"
#include "top_series.h"

#include "binary_powers.h"

#include "series_terms.h"
#include "stage_sums.h"

#include "lane_vectors.h"

#include "lane_effects.h"
#include "lane_products.h"
#include "lane_roots.h"
#include "lane_series.h"
#include "lane_work.h"

const struct kernels KERNELS = {
    .expand_body = expand_body,
    .expand_top = expand_top,
    .expand_effects = expand_effects,
    .length_of_step = length_of_step,
    .add_terms = add_terms,
    .add_terms_at = add_terms_at,
    .find_stages = find_stages,
    .find_effects_stages = find_effects_stages,
    .sum_stages = sum_stages,
    .expand_lanes = expand_lanes,
    .carry_tangents = carry_tangents,
    .expand_affected_lanes = expand_affected_lanes,
    .add_lane_work = add_lane_work,
    .multiply_lanes = multiply_lanes,
    .multiply_slopes = multiply_slopes,
    .square_lanes = square_lanes,
    .find_force_slopes = find_force_slopes,
    .find_changes = find_changes,
    .refine_root = refine_root,
};
