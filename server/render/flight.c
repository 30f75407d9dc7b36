/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A short list. */
#include "render/flight.h"

#include "gpu/program.h"

bool flights_init(struct flights *flights, struct log *log)
{
    flights->program = program_create(log, program_params(.compute = "markers.comp"));
    for (int i = 0; i < FLIGHTS; i++)
        flights->at[i].markers.program = flights->at[i].labels.program = flights->program;
    return flights->program != 0;
}

void flights_finish(struct flights *flights)
{
    for (int i = 0; i < FLIGHTS; i++) {
        readback_finish(&flights->at[i].readback);
        sights_finish(&flights->at[i].markers);
        sights_finish(&flights->at[i].labels);
    }
    program_destroy(&flights->program);
}

struct flight *flights_take(struct flights *flights, struct log *log)
{
    for (int i = 0; i < FLIGHTS; i++)
        if (!flights->at[i].taken) {
            flights->at[i].taken = true;
            return &flights->at[i];
        }
    log_err(log, "%d pictures are under way: no room for one more", FLIGHTS);
    return NULL;
}

void flights_give(struct flight *flight)
{
    if (!flight)
        return;
    readback_forget(&flight->readback);
    flight->taken = false;
}
