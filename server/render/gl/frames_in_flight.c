/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A fixed array of slots for frames whose results the GPU is still computing. */
#include "render/gl/frames_in_flight.h"

#include "gpu/program.h"

bool frames_in_flight_init(struct frames_in_flight *frames_in_flight, struct log *log)
{
    frames_in_flight->program = program_create(log, program_params(.compute = "point_visibility.comp"));
    for (int i = 0; i < FRAMES_IN_FLIGHT; i++)
        frames_in_flight->at[i].markers.program = frames_in_flight->at[i].labels.program = frames_in_flight->program;
    frames_in_flight->depth_program = program_create(log, program_params(.compute = "depth_cells.comp"));
    for (int i = 0; i < FRAMES_IN_FLIGHT; i++)
        frames_in_flight->at[i].depth.program = frames_in_flight->depth_program;
    return frames_in_flight->program && frames_in_flight->depth_program;
}

void frames_in_flight_finish(struct frames_in_flight *frames_in_flight)
{
    for (int i = 0; i < FRAMES_IN_FLIGHT; i++) {
        readback_finish(&frames_in_flight->at[i].readback);
        point_visibility_finish(&frames_in_flight->at[i].markers);
        point_visibility_finish(&frames_in_flight->at[i].labels);
        depth_query_finish(&frames_in_flight->at[i].depth);
    }
    program_destroy(&frames_in_flight->program);
    program_destroy(&frames_in_flight->depth_program);
}

struct frame_in_flight *frames_in_flight_take(struct frames_in_flight *frames_in_flight, struct log *log)
{
    for (int i = 0; i < FRAMES_IN_FLIGHT; i++)
        if (!frames_in_flight->at[i].taken) {
            frames_in_flight->at[i].taken = true;
            return &frames_in_flight->at[i];
        }
    log_err(log, "a picture was not drawn, because all %d slots for pictures in progress on the GPU are in use", FRAMES_IN_FLIGHT);
    return NULL;
}

void frames_in_flight_give(struct frame_in_flight *in_flight)
{
    if (!in_flight)
        return;
    readback_drop(&in_flight->readback);
    in_flight->taken = false;
}
