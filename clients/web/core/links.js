// SPDX-License-Identifier: GPL-3.0-or-later
// Links that open the page elsewhere, at what is seen here.
import { writeAddress } from './address.js';

// { view, follow, tag (where one is chosen), asset (likewise) }: whole addresses. A code of fewer modules is easier to read, so that those
// to tag and equipment say nothing else.
export function shareLinks({ location, session, tag }) {
    const { camera, params, time, ownParams: own } = session, page = `${location.origin}${location.pathname}`;
    const asset = params.selected;
    const links = { view: page + writeAddress({ camera, params, tag, time, own }) };
    if (tag)
        links.tag = page + writeAddress({ tag });
    if (asset)
        links.asset = page + writeAddress({ params: { selected: asset } });
    links.follow = `${page}#follow=${session.following?.session ?? session.id}`;
    return links;
}
