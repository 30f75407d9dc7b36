// SPDX-License-Identifier: GPL-3.0-or-later
// Links that open the current view on another device.
import { writeAddress } from './address.js';

// Returns URLs: { view, follow, tag and asset (if one is selected) }. The links to the tag and to the asset contain nothing else, since QR
// codes with fewer modules are easier to scan.
export function shareLinks({ location, session, tag }) {
    const { camera, params, time, ownParams: own } = session, page = `${location.origin}${location.pathname}`;
    const asset = params.selected;
    const links = { view: page + writeAddress({ camera, params, tag, time, own }) };
    if (tag)
        links.tag = page + writeAddress({ tag });
    if (asset)
        links.asset = page + writeAddress({ params: { selected: asset } });
    const { node } = session.model?.plant ?? {}; // name of the server's node, by which a load balancer routes followers to it
    links.follow = `${page}${node ? `?node=${node}` : ''}#follow=${session.following?.session ?? session.id}`;
    return links;
}
