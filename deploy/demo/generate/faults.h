/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The faults that CAD exports have, put in on purpose. This is the one list of them.

   By the way the solids are built, everywhere:
     interpenetration  necks end inside shells, studs pass through flanges, pipes end inside hubs, posts inside plinths
     unwelded          every hard edge and every joint of two solids has vertices of its own; no two solids share one
     open ends         pipes, necks and bars have no caps; wrapper plates lie on shells without touching them everywhere
     long thin faces   beams, rails and tube caps are two triangles per length or fans from one rim vertex
   By faults_apply, on some shells (E-101, E-102, T-101, V-101, TK-101):
     unwelded patch    a patch of a smooth surface whose vertices are doubled: no edge joins it to the rest
     hair gap          such a patch drawn 0.2 to 1 mm to its own middle: the gap is smaller than the eye sees
     repeated faces    some triangles are there twice
     flipped faces     a few triangles on the underside have the wrong winding
     slivers           some triangles are cut at a point 0.1 mm from an edge: aspect ratios of several hundred */
#ifndef GENERATE_FAULTS_H
#define GENERATE_FAULTS_H
#include "model.h"

void faults_apply(struct model *model);

#endif
