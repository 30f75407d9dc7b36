/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sweeping a pipe along its corner points. */
#include "pipe.h"

#include <assert.h>

#include "fitting.h"
#include "shape.h"

#define STATION_MAX 512

static void push(struct pipe *pipe, struct vec point)
{
    if (pipe->count && vec_length(vec_sub(point, pipe->points[pipe->count - 1])) < 1e-6)
        return;
    if (pipe->count >= 2) { /* straight on: one leg */
        struct vec *last = pipe->points + pipe->count - 1;
        double turn = vec_dot(vec_unit(vec_sub(*last, last[-1])), vec_unit(vec_sub(point, *last)));
        assert(turn > -0.99); /* no way back along itself */
        if (turn > 1.0 - 1e-9) {
            *last = point;
            return;
        }
    }
    assert(pipe->count < PIPE_MAX_POINTS);
    pipe->points[pipe->count++] = point;
}

static struct mesh *bare_mesh(struct pipe *pipe)
{
    return item_part(pipe->item, pipe->material == MATERIAL_COOLING_WATER ? "water pipe" : "pipe", pipe->material);
}

static double stub_m(const struct pipe *pipe)
{
    return fitting_flange_thickness(pipe->r) * 2.6 + pipe->r * 3.2 + 0.05;
}

static void mating_flange(struct pipe *pipe, const struct model_nozzle *nozzle)
{
    struct frame face = frame_facing(nozzle->at.o, vec_scale(nozzle->at.z, -1.0), nozzle->at.x);
    fitting_flange(bare_mesh(pipe), face, nozzle->r);
    fitting_studs(item_part(pipe->item, "bolts", MATERIAL_BOLTING), face, nozzle->r);
    if (fabs(nozzle->r - pipe->r) > 1e-3) { /* reducer */
        double hub = fitting_flange_thickness(nozzle->r) * 2.5;
        shape_tube(bare_mesh(pipe), frame_moved(frame_facing(nozzle->at.o, nozzle->at.z, nozzle->at.x), 0, 0, hub), nozzle->r, pipe->r,
                   1.6 * fmax(nozzle->r, pipe->r), 20, 0);
    }
}

struct pipe pipe_from_point(struct site *site, struct item *item, struct vec point, double r, enum material material, double insulation)
{
    struct pipe pipe = { .site = site, .item = item, .material = material, .r = r, .insulation = insulation, .step_m = 0.5 };
    push(&pipe, point);
    return pipe;
}

struct pipe pipe_from_nozzle(struct site *site, struct item *item, const char *name, double r, enum material material, double insulation)
{
    const struct model_nozzle *nozzle = model_nozzle(&site->model, name);
    struct pipe pipe = pipe_from_point(site, item, nozzle->at.o, r, material, insulation);
    mating_flange(&pipe, nozzle);
    push(&pipe, vec_along(nozzle->at.o, nozzle->at.z, stub_m(&pipe)));
    return pipe;
}

void pipe_go(struct pipe *pipe, const char *axes, struct vec to)
{
    struct vec p = pipe->points[pipe->count - 1];
    for (; *axes; axes++) {
        if (*axes == 'x')
            p.x = to.x;
        else if (*axes == 'y')
            p.y = to.y;
        else
            p.z = to.z;
        push(pipe, p);
    }
}

void pipe_into_nozzle(struct pipe *pipe, const char *axes, const char *name)
{
    const struct model_nozzle *nozzle = model_nozzle(&pipe->site->model, name);
    pipe_go(pipe, axes, vec_along(nozzle->at.o, nozzle->at.z, stub_m(pipe)));
    push(pipe, nozzle->at.o);
    mating_flange(pipe, nozzle);
}

static struct frame on_last_leg(const struct pipe *pipe, double along, struct vec x)
{
    struct vec a = pipe->points[pipe->count - 2], dir = vec_unit(vec_sub(pipe->points[pipe->count - 1], a));
    return frame_facing(vec_along(a, dir, along), dir, x);
}

static void open_cladding(struct pipe *pipe, struct vec centre)
{
    assert(pipe->gap_count < 4);
    pipe->gaps[pipe->gap_count++] = (struct pipe_gap){ centre, fitting_valve_length(pipe->r) / 2 + 0.12 };
}

void pipe_gate_valve(struct pipe *pipe, double along, struct vec wheel)
{
    open_cladding(pipe, on_last_leg(pipe, along, wheel).o);
    fitting_gate_valve(pipe->item, on_last_leg(pipe, along, wheel), pipe->r);
}

void pipe_control_valve(struct pipe *pipe, double along, struct vec actuator)
{
    open_cladding(pipe, on_last_leg(pipe, along, actuator).o);
    fitting_control_valve(pipe->item, on_last_leg(pipe, along, actuator), pipe->r);
}

void pipe_post(struct pipe *pipe, double along)
{
    struct frame at = on_last_leg(pipe, along, vec(0, 0, 1));
    struct vec under = vec(at.o.x, at.o.y, at.o.z - pipe->r - pipe->insulation);
    fitting_post(&pipe->site->access, &pipe->site->civil, under, pipe->r);
}

static void blind(struct pipe *pipe, struct vec end, struct vec dir)
{
    double r = fitting_flange_radius(pipe->r), thick = fitting_flange_thickness(pipe->r);
    shape_cylinder(bare_mesh(pipe), frame_moved(frame_facing(end, dir, vec(0, 0, 1)), 0, 0, -thick), r, 2 * thick, 20, 0);
}

void pipe_blind_first(struct pipe *pipe)
{
    blind(pipe, pipe->points[0], vec_sub(pipe->points[0], pipe->points[1]));
}

void pipe_blind_last(struct pipe *pipe)
{
    blind(pipe, pipe->points[pipe->count - 1], vec_sub(pipe->points[pipe->count - 1], pipe->points[pipe->count - 2]));
}

struct track { /* the centre line, finely */
    struct station stations[STATION_MAX];
    double at_m[STATION_MAX];
    int count;
};

static void track_push(struct track *track, struct vec centre, struct vec tangent)
{
    assert(track->count < STATION_MAX);
    double length = track->count ? vec_length(vec_sub(centre, track->stations[track->count - 1].centre)) : 0.0;
    if (track->count && length < 1e-6)
        return;
    track->at_m[track->count] = track->count ? track->at_m[track->count - 1] + length : 0.0;
    track->stations[track->count++] = (struct station){ centre, tangent };
}

static void track_straight(struct track *track, struct vec from, struct vec to, double step_m)
{
    struct vec d = vec_sub(to, from), dir = vec_unit(d);
    int pieces = (int)fmax(1.0, ceil(vec_length(d) / step_m));
    for (int i = 0; i <= pieces; i++)
        track_push(track, vec_along(from, d, (double)i / pieces), dir);
}

struct bend { /* long-radius elbow (1.5 D), shorter where the legs are */
    struct vec in, out;
    double angle, cut; /* cut: from the corner to where the arc begins */
};

static struct bend bend_at(const struct vec *corner, double r)
{
    struct vec before = vec_sub(corner[0], corner[-1]), after = vec_sub(corner[1], corner[0]);
    struct bend bend = { .in = vec_unit(before), .out = vec_unit(after) };
    bend.angle = acos(fmax(-1.0, fmin(1.0, vec_dot(bend.in, bend.out))));
    bend.cut = fmin(3.0 * r * tan(bend.angle / 2), 0.5 * fmin(vec_length(before), vec_length(after)));
    return bend;
}

static void track_bend(struct track *track, struct vec corner, const struct bend *bend)
{
    double radius = bend->cut / tan(bend->angle / 2);
    struct vec begin = vec_along(corner, bend->in, -bend->cut);
    struct vec inward = vec_unit(vec_sub(bend->out, vec_scale(bend->in, vec_dot(bend->in, bend->out))));
    struct vec centre = vec_along(begin, inward, radius);
    int pieces = (int)ceil(bend->angle / RADIANS(18.0));
    for (int i = 0; i <= pieces; i++) {
        double a = bend->angle * i / pieces;
        struct vec arm = vec_add(vec_scale(inward, -radius * cos(a)), vec_scale(bend->in, radius * sin(a)));
        track_push(track, vec_add(centre, arm), vec_add(vec_scale(bend->in, cos(a)), vec_scale(inward, sin(a))));
    }
}

static void track_build(struct track *track, const struct pipe *pipe)
{
    struct vec from = pipe->points[0], last = pipe->points[pipe->count - 1];
    for (int i = 1; i + 1 < pipe->count; i++) {
        struct vec corner = pipe->points[i];
        struct bend bend = bend_at(pipe->points + i, pipe->r);
        track_straight(track, from, vec_along(corner, bend.in, -bend.cut), pipe->step_m);
        track_bend(track, corner, &bend);
        from = vec_along(corner, bend.out, bend.cut);
    }
    track_straight(track, from, last, pipe->step_m);
}

static struct station track_at(const struct track *track, double at_m)
{
    int i = 1;
    while (i + 1 < track->count && track->at_m[i] < at_m)
        i++;
    double t = (at_m - track->at_m[i - 1]) / (track->at_m[i] - track->at_m[i - 1]);
    const struct station *a = track->stations + i - 1, *b = a + 1;
    return (struct station){ vec_lerp(a->centre, b->centre, t), vec_unit(vec_lerp(a->tangent, b->tangent, t)) };
}

static int pipe_sides(double r)
{
    return r < 0.04 ? 10 : r < 0.07 ? 14 : r < 0.13 ? 18 : 20;
}

static void sweep_between(struct mesh *mesh, const struct track *track, double from_m, double to_m, double r)
{
    struct station stations[STATION_MAX + 2];
    int count = 0;
    stations[count++] = track_at(track, from_m);
    for (int i = 0; i < track->count; i++)
        if (track->at_m[i] > from_m + 1e-4 && track->at_m[i] < to_m - 1e-4)
            stations[count++] = track->stations[i];
    stations[count++] = track_at(track, to_m);
    shape_sweep(mesh, stations, count, r, pipe_sides(r));
}

static void cladding_end(struct mesh *mesh, struct station at, double sign, double r, double thick)
{
    struct profile profile = { 0 };
    profile_edge(&profile, r + thick, 0);
    profile_edge(&profile, r * 0.98, 0.012);
    shape_revolve(mesh, frame_facing(at.centre, vec_scale(at.tangent, sign), vec(0, 0, 1)), &profile, pipe_sides(r + thick), 0);
}

static double track_nearest(const struct track *track, struct vec point)
{
    double best = INFINITY, at_m = 0.0;
    for (double m = 0.0; m < track->at_m[track->count - 1]; m += 0.02) {
        double distance = vec_length(vec_sub(track_at(track, m).centre, point));
        if (distance < best) {
            best = distance;
            at_m = m;
        }
    }
    return at_m;
}

static void clad(struct pipe *pipe, const struct track *track, double from_m, double to_m)
{
    if (to_m - from_m < 0.05)
        return;
    struct mesh *cladding = item_part(pipe->item, "cladding", MATERIAL_CLADDING);
    sweep_between(cladding, track, from_m, to_m, pipe->r + pipe->insulation);
    cladding_end(cladding, track_at(track, from_m), -1, pipe->r, pipe->insulation);
    cladding_end(cladding, track_at(track, to_m), 1, pipe->r, pipe->insulation);
}

void pipe_end(struct pipe *pipe)
{
    struct track track = { .count = 0 };
    track_build(&track, pipe);
    double length = track.at_m[track.count - 1], open = fitting_flange_thickness(pipe->r) * 2.6 + 0.09;
    struct mesh *bare = bare_mesh(pipe);
    if (pipe->insulation <= 0.0 || length < 3 * open) {
        sweep_between(bare, &track, 0, length, pipe->r);
        return;
    }
    double bare_from = 0.0, clad_from = open;
    for (int i = 0; i <= pipe->gap_count; i++) { /* the gaps were made in order along the pipe */
        bool last = i == pipe->gap_count;
        double centre = last ? length : track_nearest(&track, pipe->gaps[i].centre), half = last ? open : pipe->gaps[i].half_m;
        sweep_between(bare, &track, bare_from, clad_from + 0.02, pipe->r);
        clad(pipe, &track, clad_from, centre - half);
        bare_from = fmax(centre - half - 0.02, clad_from);
        clad_from = centre + half;
    }
    sweep_between(bare, &track, bare_from, length, pipe->r);
}
