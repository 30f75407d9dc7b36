// SPDX-License-Identifier: GPL-3.0-or-later
// Details of the selected equipment, shown below the equipment list, with links to other systems.
import { numberText } from '../../core/format.js';
import { linkUrl } from '../../core/references.js';
import { say } from '../../core/words.js';
import { byId, make } from '../common/dom.js';

const metres = (list, between) => list.map((m) => numberText(m, 1)).join(between);

export const linksOf = (model, of, item) => model.references.filter((link) => link.of === of)
    .map((link) => ({ name: link.name, href: linkUrl(link, item) })).filter(({ href }) => href)
    .map(({ name, href }) => make('a', { href, target: '_blank', rel: 'noopener noreferrer' }, name));

export class About {
    constructor({ session }) {
        this.session = session;
        this.element = byId('asset-about');
    }

    show() {
        const { model, params } = this.session, asset = model.asset(params.selected);
        this.element.hidden = !asset;
        if (!asset)
            return;
        const { min, max } = asset.bounds;
        const facts = [
            ['assets.missing', asset.missing], ['assets.description', asset.description], ['assets.area', asset.area],
            ['assets.size', say('distance.metres', { metres: metres(max.map((m, i) => m - min[i]), ' × ') })],
            ['assets.place', metres(max.map((m, i) => (m + min[i]) / 2), ' · ')],
            ['assets.sensors.name', asset.tags.length],
        ].filter(([, text]) => text !== '' && text !== undefined && text !== 0);
        const links = linksOf(model, 'asset', asset), named = facts.map(([key, text]) => [say(key), text]);
        this.element.replaceChildren(make('h3', {}, asset.tag || asset.id),
            make('dl', {}, ...[...named, ...(asset.properties ?? [])].flatMap(([name, text]) =>
                [make('dt', {}, name), make('dd', {}, String(text))])),
            ...(links.length > 0 ? [make('p', { class: 'links' }, ...links)] : []));
    }
}
