// SPDX-License-Identifier: GPL-3.0-or-later
// Makes links that open the current view on another device.
import { writeAddress } from './address.js';

// Roles whose views the server stores under a short link.
export const SHARERS = ['viewer', 'operator', 'engineer'];
export const shortLink = (location, id) => new URL(`v/${id}`, location.origin + location.pathname).href;

// Returns URLs { view, follow, tag, asset }; the last two only if a tag or an asset is selected. The links to tag and asset contain nothing
// else, because QR codes of short links are easier to scan.
export function shareLinks({ location, session, tag }) {
    const { camera, params, time, ownParams: own, named } = session, page = `${location.origin}${location.pathname}`;
    const asset = params.selected;
    const links = { view: page + writeAddress({ camera, params, tag, time, own, named }) };
    if (tag)
        links.tag = page + writeAddress({ tag });
    if (asset)
        links.asset = page + writeAddress({ params: { selected: asset } });
    // name of this server behind a load balancer, which uses the name to send followers to the same server
    const { node } = session.model?.plant ?? {};
    links.follow = `${page}${node ? `?node=${node}` : ''}#follow=${session.following?.session ?? session.id}`;
    return links;
}
