// The fundamental matrix of a step in double precision, V' = h J V but for a small defect, and axes of errors.
#include "ball_tube.h"
#ifdef SPINTOP_FLINT
#include <math.h>
#include <string.h>

// The largest defect of the matrix of a step, multiplied by the growth of errors.
static const double most_defect = 0x1p-22;

double ball_norm(const double *m, int count) {
    double sum = 0;
    while (count--) sum += m[count] * m[count];
    return sqrt(sum) * SAFE;
}

void ball_multiply(matrix product, const matrix a, const matrix b) {
    int i, j, k;
    memset(product, 0, sizeof(matrix));
    for (i = 0; i < STATES; i++)
        for (k = 0; k < STATES; k++)
            for (j = 0; j < STATES; j++) AT(product, i, j) += AT(a, i, k) * AT(b, k, j);
}

// The order k of h J.
static void find_jacobian(matrix jacobian, const ball_step *step, int k) {
    const ball_field *f = step->field;
    const int n = f->order + 1;
    const double h = ldexp(step->sense, -(int)step->halvings), *x = step->real;
    int c, t, a, b, i, j, wave;
    memset(jacobian, 0, sizeof(matrix));
    for (c = 0; c < 4; c++)
        for (t = 0; t < 3; t++) {
            double sign = ball_product(c, t, &a, &i, 0);
            AT(jacobian, c, a) += sign * x[(4 + i) * n + k] / 2, AT(jacobian, c, 4 + i) += sign * x[a * n + k] / 2;
            if (k == 0) sign = ball_product(c, t, &a, &i, 1), AT(jacobian, c, a) -= sign * f->o[i] / 2;
        }
    for (i = 0; i < 3; i++) {
        const int u = (i + 1) % 3, v = (i + 2) % 3;
        AT(jacobian, 4 + i, 4 + u) += f->c[i] * x[(4 + v) * n + k], AT(jacobian, 4 + i, 4 + v) += f->c[i] * x[(4 + u) * n + k];
    }
    for (wave = 0; wave < WAVES; wave++)
        for (i = 0; i < 3 && f->has_wave[wave]; i++) {
            const double *u = step->u + wave * n;
            for (j = 0; j < 3; j++) AT(jacobian, 4 + i, 4 + j) += f->h[wave][i][j] * u[k];
            for (b = 0; b < 4; b++) {
                double sum = 0;
                for (j = 0; j <= k; j++) sum += u[j] * x[b * n + k - j];
                for (a = 0; a < 4; a++) AT(jacobian, 4 + i, a) += 2 * f->t[wave][i][a][b] * sum;
            }
        }
    for (i = 0; i < STATES * STATES; i++) jacobian[i] *= h;
}

// Bounds of D = V' - h J V by orders, divided by them: rounding, and what is left beyond the degree.
static void find_defect(ball_step *step) {
    const int count = 2 * step->field->order + 1;
    int i, j;
    memset(step->defect, 0, (size_t)(count + step->degree) * sizeof(double));
    for (i = 0; i < count; i++)
        for (j = 0; j <= step->degree; j++) step->defect[i + j] += step->jacobian[i] * step->v_norm[j];
    for (i = 0; i < count + step->degree; i++) step->defect[i] *= SAFE * (i < step->degree ? ROUNDING : 1) / (i + 1);
}

void ball_find_matrix(ball_step *step, double s) {
    const int most = FLINT_MIN(step->field->order, MATRICES - 1), count = 2 * step->field->order + 1;
    const double growth = exp(fmin(ball_series(step->growth, count, s, 1), 700));
    matrix jacobian[MATRICES], product;
    int i, j, k, n;
    memset(step->v[0], 0, sizeof(matrix));
    for (i = 0; i < STATES; i++) AT(step->v[0], i, i) = 1;
    for (n = 0; n == 0 || (n < most && (n % 4 || growth * ball_series(step->defect, count + n, s, 1) > most_defect)); n++) {
        double *next = step->v[n + 1];
        find_jacobian(jacobian[n], step, n);
        memset(next, 0, sizeof(matrix));
        for (k = 0; k <= n; k++) {
            ball_multiply(product, jacobian[n - k], step->v[k]);
            for (j = 0; j < STATES * STATES; j++) next[j] += product[j] / (n + 1);
        }
        step->degree = n + 1, step->v_norm[0] = ball_norm(step->v[0], STATES * STATES);
        step->v_norm[n + 1] = ball_norm(next, STATES * STATES);
        if (step->degree % 4 == 0 || step->degree == most) find_defect(step);
    }
}

double ball_matrix_at(matrix v, const ball_step *step, double s) {
    int j, k;
    memset(v, 0, sizeof(matrix));
    for (k = step->degree; k >= 0; k--)
        for (j = 0; j < STATES * STATES; j++) v[j] = v[j] * s + step->v[k][j];
    return ball_series(step->v_norm, step->degree + 1, s, 0);
}

int ball_invert(matrix inverse, const matrix m) {
    double row[STATES][2 * STATES] = {{0}};
    int i, j, k;
    for (i = 0; i < STATES; i++) memcpy(row[i], m + i * STATES, sizeof row[i] / 2), row[i][STATES + i] = 1;
    for (k = 0; k < STATES; k++) {
        int pivot = k;
        double kept;
        for (i = k + 1; i < STATES; i++)
            if (fabs(row[i][k]) > fabs(row[pivot][k])) pivot = i;
        for (j = 0; j < 2 * STATES; j++) kept = row[k][j], row[k][j] = row[pivot][j], row[pivot][j] = kept;
        kept = row[k][k];
        if (!(fabs(kept) > 0)) return 0;
        for (j = 0; j < 2 * STATES; j++) row[k][j] /= kept;
        for (i = 0; i < STATES; i++) {
            const double factor = row[i][k];
            for (j = 0; j < 2 * STATES && i != k; j++) row[i][j] -= factor * row[k][j];
        }
    }
    for (i = 0; i < STATES; i++) memcpy(inverse + i * STATES, row[i] + STATES, sizeof row[i] / 2);
    return 1;
}

// Gram and Schmidt, the columns in the order of their lengths times their radii, twice against rounding.
void ball_orthogonal(matrix q, const matrix a, const double radius[STATES]) {
    double column[STATES][STATES], length[STATES], along;
    int i, j, k, pass, longest;
    for (j = 0; j < STATES; j++) {
        for (i = 0; i < STATES; i++) column[j][i] = AT(a, i, j);
        length[j] = ball_norm(column[j], STATES) * radius[j];
    }
    for (k = 0; k < STATES; k++) {
        for (longest = 0, j = 1; j < STATES; j++)
            if (length[j] > length[longest]) longest = j;
        length[longest] = -1;
        for (pass = 0; pass < 2 * k; pass++) {
            for (along = 0, i = 0; i < STATES; i++) along += AT(q, i, pass % k) * column[longest][i];
            for (i = 0; i < STATES; i++) column[longest][i] -= along * AT(q, i, pass % k);
        }
        for (i = 0; i < STATES; i++) AT(q, i, k) = column[longest][i] / ball_norm(column[longest], STATES);
    }
}
#endif
