// SPDX-License-Identifier: GPL-3.0-or-later
// Handles the link that opened the page: goes to the tag or equipment that it names, and reports the parts that this plant does
// not have.
import { SHARERS } from '../../core/links.js';
import { put, refusalText } from '../../core/refusals.js';
import { expand } from './short_link.js';

const NOTE_MS = 20000;

export class Arrival {
    constructor(page) {
        this.page = page;
    }

    // link: { camera, params, tag, short, expanded } of the link that opened the page; null after the first call. refused: the server's
    // `error` messages that refuse parts of this page's view.
    come(link, refused) {
        const { session, selection, selectTag, tell } = this.page, { model } = session;
        const why = refused.map(({ text, refusal }) => refusalText(text, refusal)), unknown = selection.tag && !model.tag(selection.tag);
        if (unknown) {
            why.push(put('no_tag', { name: selection.tag }));
            selectTag(null);
        }
        if (link && !link.camera)
            this.goTo(model.tag(link.tag), model.asset(link.params.selected));
        if (link?.short)
            this.open(link);
        if (why.length > 0)
            tell(put(link ? 'page.link' : 'page.refused', { why: why.join('; '), text: why.join('; ') }), NOTE_MS);
    }

    // Marks a short link as used. If the link could not be opened before the user signed in, opens it now.
    async open({ short, expanded }) {
        const { session, tell } = this.page;
        if (expanded && SHARERS.includes(session.role))
            session.post({ type: 'share_view', seq: ++session.toldSeq, view: expanded });
        if (!expanded)
            await expand(short, session.token).then(() => location.reload(),
                (error) => tell(put('page.link', { why: error.message }), NOTE_MS));
    }

    goTo(tag, asset) {
        const { session, flyToTag, fitView } = this.page;
        if (tag?.group && tag.group !== session.params.group)
            session.setParams({ group: tag.group });
        if (tag)
            flyToTag(tag);
        else if (asset)
            fitView();
    }
}
