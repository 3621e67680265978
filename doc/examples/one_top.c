/* The motion of one top in C99: in closed form with a derivative, and by RK4 with its true error; its events; an input that
 * is wrong. */
#include <spintop.h>

#include <stdio.h>

#define TOP                                                                                                            \
    "&top mass = 1 inertia = 0.875, 0.875, 0.25 length = 0.8660254037844387 /\n"                                       \
    "&initial theta_deg = 11.25 psi_rate = 1 /\n"

/* Prints an error and deletes it; returns its code. */
static int tell(spintop_error *error) {
    int code = error->code;
    printf("code %d, %s:%d:%d\n%s\n", code, error->source, error->line, error->column, error->message);
    spintop_error_delete(error);
    return code;
}

/* The columns of a top at three times. */
static int show_motion(const char *input) {
    const double t[3] = {0.0, 1.0, 2.0};
    double cells[8 * 3];
    spintop_error *error = NULL;
    spintop_top *top = spintop_top_new(input, NULL, &error);
    if (top == NULL) return tell(error);
    const spintop_column *columns = spintop_top_columns(top);
    int count = spintop_top_column_count(top);
    int code = spintop_top_at(top, 3, t, cells, &error);
    for (int c = 0; code == SPINTOP_OK && c < count; ++c) {
        printf("%-18s [%s]", columns[c].name, columns[c].unit);
        for (int i = 0; i < 3; ++i) printf(" %.15g", cells[3 * c + i]);
        printf("\n");
    }
    spintop_top_delete(top);
    return code == SPINTOP_OK ? code : tell(error);
}

/* The events in a motion. */
static int show_events(const char *input) {
    spintop_error *error = NULL;
    spintop_top *top = spintop_top_new(input, NULL, &error);
    if (top == NULL) return tell(error);
    spintop_result *result = spintop_top_events(top, &error);
    spintop_top_delete(top); /* the result does not need it */
    if (result == NULL) return tell(error);
    for (int k = 0; k < result->table_count; ++k) {
        const spintop_table *table = &result->tables[k];
        printf("table %s: %lld rows\n", table->name, table->row_count);
        for (long long i = 0; i < table->row_count; ++i) {
            for (long long c = 0; c < table->column_count; ++c) {
                const spintop_column *column = &table->columns[c];
                if (column->words != NULL) {
                    printf("%s ", column->words[(size_t)column->values[i]]);
                } else {
                    printf("%.15g ", column->values[i]);
                }
            }
            printf("\n");
        }
    }
    spintop_result_delete(result);
    return SPINTOP_OK;
}

int main(void) {
    printf("spintop %s, interface %d\n", spintop_version(), spintop_interface());
    if (spintop_interface() != SPINTOP_INTERFACE) return 1;
    if (show_motion(TOP "&span t_end = 2 / &output columns = 't', 'theta', 'phi', 'theta__top.mass' /") != SPINTOP_OK) return 1;
    if (show_motion(TOP "&span t_end = 2 / &integration method = 'rk4' steps = 100 / "
                        "&output columns = 'theta', 'orientation_error' /") != SPINTOP_OK)
        return 1;
    if (show_events(TOP "&span nutations = 2 / &output events = 'lower_turning_points' columns = 't', 'theta' /") != SPINTOP_OK)
        return 1;
    return show_motion("&top mass = -1 /") == SPINTOP_BAD_INPUT ? 0 : 1;
}
