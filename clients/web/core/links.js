// SPDX-License-Identifier: GPL-3.0-or-later
// Links that open the current view on another device.
import { writeAddress } from './address.js';

// Roles whose views the server stores for short links.
export const SHARERS = ['viewer', 'operator', 'engineer'];
export const shortLink = (location, id) => new URL(`v/${id}`, location.origin + location.pathname).href;

// Returns URLs { view, follow, tag, asset }; the last two only if one is selected. Links to tag and asset contain nothing else, because QR
// codes with fewer modules are easier to scan.
export function shareLinks({ location, session, tag }) {
    const { camera, params, time, ownParams: own, named } = session, page = `${location.origin}${location.pathname}`;
    const asset = params.selected;
    const links = { view: page + writeAddress({ camera, params, tag, time, own, named }) };
    if (tag)
        links.tag = page + writeAddress({ tag });
    if (asset)
        links.asset = page + writeAddress({ params: { selected: asset } });
    const { node } = session.model?.plant ?? {}; // name of the server's node, with which a load balancer sends followers to that node
    links.follow = `${page}${node ? `?node=${node}` : ''}#follow=${session.following?.session ?? session.id}`;
    return links;
}
