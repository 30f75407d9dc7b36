/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Assembles the finite element matrices of the heat method (laplacian.h) from the contributions of single triangles. */
#include "surface/geodesic/laplacian.h"

#include <dlfcn.h>
#include <pthread.h>

#include "base/math/vec.h"
#include "base/mem.h"

static pthread_once_t blas_once = PTHREAD_ONCE_INIT;
/* Lets OpenBLAS use one thread, because the workers use all cores already. Other BLAS libraries do not have this function. */
static void blas_alone(void)
{
    void (*set_threads)(int count);
    *(void **)&set_threads = dlsym(RTLD_DEFAULT, "openblas_set_num_threads");
    if (set_threads)
        set_threads(1);
}

void laplacian_start(cholmod_common *common)
{
    pthread_once(&blas_once, blas_alone);
    cholmod_start(common);
    common->print = 0;
    common->final_ll = 1;
    common->nmethods = 1;
    common->method[0].ordering = CHOLMOD_AMD;
    common->postorder = 1;
}

static void number_rows(struct laplacian *laplacian)
{
    const struct intrinsic *in = laplacian->in;
    for (size_t i = 0; i < in->point_count; i++)
        laplacian->row_of[i] = TRIMESH_NONE;
    for (size_t t = 0; t < in->tri_count; t++)
        for (int i = 0; i < 3; i++)
            laplacian->row_of[in->points[t][i]] = 0;
    for (size_t i = 0; i < in->point_count; i++)
        if (laplacian->row_of[i] == 0)
            laplacian->row_of[i] = (uint32_t)laplacian->row_count++;
}

static void measure(struct laplacian *laplacian)
{
    const struct intrinsic *in = laplacian->in;
    for (size_t t = 0; t < in->tri_count; t++) {
        double x, y, a = in->lengths[t][0];
        intrinsic_layout(in->lengths[t], &x, &y);
        y = max_of(y, 1e-6 * a); /* limits the height of a triangle that rounding has flattened, because slopes are divided by the height */
        laplacian->slopes[t] = (struct laplacian_slope){ .x1 = 1 / a, .y1 = -x / (a * y), .y2 = 1 / y, .area = a * y / 2 };
        for (int i = 0; i < 3; i++)
            laplacian->mass_m2[laplacian->row_of[in->points[t][i]]] += a * y / 6;
    }
}

bool laplacian_init(struct laplacian *laplacian, const struct intrinsic *in)
{
    *laplacian = (struct laplacian){ .in = in };
    laplacian->row_of = mem_try_array(in->point_count, sizeof(*laplacian->row_of));
    laplacian->slopes = mem_try_array(in->tri_count, sizeof(*laplacian->slopes));
    laplacian->mass_m2 = mem_try_array(in->point_count, sizeof(*laplacian->mass_m2));
    if (!laplacian->row_of || !laplacian->slopes || !laplacian->mass_m2)
        return false;
    number_rows(laplacian);
    measure(laplacian);
    return true;
}

void laplacian_finish(struct laplacian *laplacian)
{
    mem_free(laplacian->row_of);
    mem_free(laplacian->slopes);
    mem_free(laplacian->mass_m2);
    *laplacian = (struct laplacian){ 0 };
}

cholmod_sparse *laplacian_assemble(const struct laplacian *laplacian, const double *mass, double stiffness, cholmod_common *common)
{
    const struct intrinsic *in = laplacian->in;
    const size_t rows_count = laplacian->row_count, most = rows_count + 6 * in->tri_count;
    cholmod_triplet *list = cholmod_allocate_triplet(rows_count, rows_count, most, -1, CHOLMOD_REAL, common);
    if (!list)
        return NULL;
    int *rows = list->i, *columns = list->j;
    double *values = list->x;
    size_t n = 0;
    for (size_t i = 0; i < rows_count; i++, n++) {
        rows[n] = columns[n] = (int)i;
        values[n] = mass[i];
    }
    for (size_t t = 0; t < in->tri_count; t++) {
        const struct laplacian_slope *s = &laplacian->slopes[t];
        const double gx[3] = { -s->x1, s->x1, 0 }, gy[3] = { -s->y1 - s->y2, s->y1, s->y2 };
        for (int i = 0; i < 3; i++)
            for (int j = 0; j <= i; j++, n++) {
                int a = (int)laplacian->row_of[in->points[t][i]], b = (int)laplacian->row_of[in->points[t][j]];
                rows[n] = a > b ? a : b;
                columns[n] = a > b ? b : a;
                values[n] = stiffness * s->area * (gx[i] * gx[j] + gy[i] * gy[j]);
                /* Edge flips can create an edge from a point to itself. Its element then lies on the matrix's diagonal, which is stored
                   once, and counts twice: from each end of the edge to the other. */
                if (i != j && a == b)
                    values[n] *= 2;
            }
    }
    list->nnz = n;
    cholmod_sparse *matrix = cholmod_triplet_to_sparse(list, n, common);
    cholmod_free_triplet(&list, common);
    return matrix;
}
