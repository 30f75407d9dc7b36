/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Points, directions and right-handed frames in metres; everything is built Z up. */
#ifndef GENERATE_VEC_H
#define GENERATE_VEC_H
#include <math.h>

#define RADIANS(deg) ((deg) * (M_PI / 180.0))

struct vec {
    double x, y, z;
};

struct frame { /* an origin and three unit axes */
    struct vec o, x, y, z;
};

static inline struct vec vec(double x, double y, double z)
{
    return (struct vec){ x, y, z };
}
static inline struct vec vec_add(struct vec a, struct vec b)
{
    return vec(a.x + b.x, a.y + b.y, a.z + b.z);
}
static inline struct vec vec_sub(struct vec a, struct vec b)
{
    return vec(a.x - b.x, a.y - b.y, a.z - b.z);
}
static inline struct vec vec_scale(struct vec a, double s)
{
    return vec(a.x * s, a.y * s, a.z * s);
}
static inline struct vec vec_along(struct vec from, struct vec dir, double length_m)
{
    return vec_add(from, vec_scale(dir, length_m));
}
static inline struct vec vec_lerp(struct vec a, struct vec b, double t)
{
    return vec_add(vec_scale(a, 1.0 - t), vec_scale(b, t));
}
static inline double vec_dot(struct vec a, struct vec b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
static inline struct vec vec_cross(struct vec a, struct vec b)
{
    return vec(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
static inline double vec_length(struct vec a)
{
    return sqrt(vec_dot(a, a));
}
static inline struct vec vec_unit(struct vec a) /* a zero vector stays zero */
{
    double length = vec_length(a);
    return length > 0.0 ? vec_scale(a, 1.0 / length) : a;
}
static inline struct vec vec_polar(double r, double deg, double z)
{
    return vec(r * cos(RADIANS(deg)), r * sin(RADIANS(deg)), z);
}

static inline struct frame frame_at(double x, double y, double z)
{
    return (struct frame){ vec(x, y, z), vec(1, 0, 0), vec(0, 1, 0), vec(0, 0, 1) };
}
static inline struct vec frame_dir(const struct frame *f, struct vec d)
{
    return vec_add(vec_add(vec_scale(f->x, d.x), vec_scale(f->y, d.y)), vec_scale(f->z, d.z));
}
static inline struct vec frame_point(const struct frame *f, struct vec p)
{
    return vec_add(f->o, frame_dir(f, p));
}
static inline struct vec frame_local(const struct frame *f, struct vec p) /* the inverse of frame_point */
{
    struct vec d = vec_sub(p, f->o);
    return vec(vec_dot(d, f->x), vec_dot(d, f->y), vec_dot(d, f->z));
}
static inline struct frame frame_in(const struct frame *outer, struct frame f)
{
    return (struct frame){ frame_point(outer, f.o), frame_dir(outer, f.x), frame_dir(outer, f.y), frame_dir(outer, f.z) };
}
static inline struct frame frame_inside(const struct frame *outer, struct frame f) /* the inverse of frame_in */
{
    struct frame turn = { vec(0, 0, 0), outer->x, outer->y, outer->z };
    return (struct frame){ frame_local(outer, f.o), frame_local(&turn, f.x), frame_local(&turn, f.y), frame_local(&turn, f.z) };
}
static inline struct frame frame_moved(struct frame f, double x, double y, double z) /* along its own axes */
{
    f.o = frame_point(&f, vec(x, y, z));
    return f;
}
static inline struct frame frame_turned(struct frame f, double deg) /* about its own z */
{
    double c = cos(RADIANS(deg)), s = sin(RADIANS(deg));
    struct vec x = f.x;
    f.x = vec_add(vec_scale(x, c), vec_scale(f.y, s));
    f.y = vec_add(vec_scale(f.y, c), vec_scale(x, -s));
    return f;
}
/* z along dir, x as near to `up` as it goes. */
static inline struct frame frame_facing(struct vec o, struct vec dir, struct vec up)
{
    struct vec z = vec_unit(dir), x = vec_sub(up, vec_scale(z, vec_dot(up, z)));
    if (vec_length(x) < 1e-6)
        x = fabs(z.x) < 0.9 ? vec_sub(vec(1, 0, 0), vec_scale(z, z.x)) : vec_sub(vec(0, 1, 0), vec_scale(z, z.y));
    x = vec_unit(x);
    return (struct frame){ o, x, vec_cross(z, x), z };
}

#endif
