// SPDX-License-Identifier: GPL-3.0-or-later
// Links to other systems about assets and tags, made from the templates in the plant file.

// Fills a template for an asset or a tag and returns the URL; null if the URL is not safe to open.
export function linkUrl({ of, url }, item) {
    const fields = of === 'tag' ? { name: item.name, asset: item.asset, group: item.group } :
        { id: item.id, tag: item.tag, area: item.area };
    const text = url.replace(/\{(\w+)\}/g, (_, name) => encodeURIComponent(fields[name] ?? ''));
    try {
        const { protocol, href } = new URL(text);
        return protocol === 'https:' || protocol === 'http:' ? href : null;
    } catch {
        return null;
    }
}
