/* Writes what the library returns for the arguments of the program, in full digits. */
#include <spintop.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int tell(spintop_error *error) {
    int code = error->code;
    printf("%d|%s|%s|%d|%d|%s\n", code, error->status, error->source, error->line, error->column, error->message);
    spintop_error_delete(error);
    return code;
}

int main(int count, char **arguments) {
    spintop_error *error = NULL;
    if (count < 3) return 99;
    if (strcmp(arguments[1], "list") == 0) {
        char *text = spintop_list(arguments[2][0] ? arguments[2] : NULL, 1, &error);
        if (text == NULL) return tell(error);
        puts(text);
        free(text);
    } else if (strcmp(arguments[1], "at") == 0) {
        double t[64], cells[64 * 8];
        size_t n = (size_t)(count - 3);
        for (size_t i = 0; i < n; ++i) t[i] = strtod(arguments[i + 3], NULL);
        spintop_top *top = spintop_top_new(arguments[2], "top", &error);
        if (top == NULL) return tell(error);
        int code = spintop_top_at(top, n, t, cells, &error);
        for (size_t i = 0; i < n; ++i) {
            for (size_t c = 0; c < (size_t)spintop_top_column_count(top); ++c) printf("%.17g ", cells[c * n + i]);
            printf("\n");
        }
        spintop_top_delete(top);
        if (code != 0) return tell(error);
    } else {
        spintop_result *result = spintop_run(arguments[2], "run", count > 3 ? arguments[3] : NULL, 1, &error);
        if (result == NULL) return tell(error);
        for (int k = 0; k < result->table_count; ++k) {
            const spintop_table *table = &result->tables[k];
            printf("%s\n", table->name);
            for (long long c = 0; c < table->column_count; ++c) {
                const spintop_column *column = &table->columns[c];
                printf("%s|%s|%s|", column->name, column->unit, column->what);
                for (long long i = 0; i < table->row_count; ++i) {
                    if (column->words != NULL) printf("%s ", column->words[(size_t)column->values[i]]);
                    else printf("%.17g ", column->values[i]);
                }
                printf("\n");
            }
        }
        int code = result->code;
        spintop_result_delete(result);
        return code;
    }
    return 0;
}
