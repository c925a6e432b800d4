/**
 * `virtual:help`: the help, made from the documents in docs/ and the changelog when the
 * dashboard is built. A link to a document that is no part of the help becomes plain words.
 */
import { readFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { Marked, type Tokens } from 'marked';
import type { Plugin } from 'vite';
import type { Searched } from '../src/help';

const id = 'virtual:help';
const index = `${id}-index`;
/** So many letters of a topic are shown in the list. */
const LEAD = 150;

/** A topic as it is made. */
type Made = Searched & { html: string };

const root = fileURLToPath(new URL('../../', import.meta.url));

/** The topics as they are listed, with their documents. */
const documents: Record<string, string> = {
  alerts: 'docs/alerts.md',
  changes: 'docs/changes.md',
  logbook: 'docs/logbook.md',
  azimuths: 'docs/azimuths.md',
  cards: 'docs/cards.md',
  'work-orders': 'docs/work-orders.md',
  plan: 'docs/plan.md',
  schedule: 'docs/schedule.md',
  reports: 'docs/reports.md',
  notifications: 'docs/notifications.md',
  mail: 'docs/mail.md',
  webhooks: 'docs/webhooks.md',
  agent: 'docs/agent.md',
  outputs: 'docs/outputs.md',
  firms: 'docs/firms.md',
  security: 'docs/security.md',
  api: 'docs/api.md',
  glossary: 'docs/GLOSSARY.md',
  changelog: 'CHANGELOG.md',
};
const topicOf = new Map(
  Object.entries(documents).map(([topic, path]) => [path.split('/').at(-1), topic]),
);

export function help(): Plugin {
  return {
    name: 'binnacle-help',
    resolveId: (asked) => (asked.startsWith(id) ? `\0${asked}` : undefined),
    load(asked) {
      if (!asked.startsWith(`\0${id}`)) return undefined;
      for (const path of Object.values(documents)) this.addWatchFile(root + path);
      const topics = Object.entries(documents).map(([topic, path]) =>
        read(topic, readFileSync(root + path, 'utf8')),
      );
      return moduleOf(asked.slice(1), topics);
    },
  };
}

/** The list of topics is a file, each one's words are another, and what is searched is a third. */
function moduleOf(asked: string, topics: Made[]): string {
  if (asked === index) {
    const sections = topics.map(({ id, title, sections }) => ({ id, title, sections }));
    return `export const index = ${JSON.stringify(sections)};`;
  }
  if (asked !== id) {
    const topic = topics.find((one) => asked === `${id}-${one.id}`);
    return `export const html = ${JSON.stringify(topic?.html ?? '')};`;
  }
  const listed = topics.map(({ id: topic, title, sections }) => {
    const lead =
      sections
        .find(({ text }) => text !== '')
        ?.text.slice(0, LEAD)
        .trim() ?? '';
    const load = `() => import('${id}-${topic}').then(({ html }) => html)`;
    return `{ ...${JSON.stringify({ id: topic, title, lead })}, load: ${load} }`;
  });
  return `export const topics = [${listed.join(',')}];
    export const loadIndex = () => import('${index}').then(({ index }) => index);`;
}

/** A heading's address, as the documents' own links have it. */
const slug = (words: string): string =>
  words
    .toLowerCase()
    .replace(/[^\p{L}\p{N}\s_-]/gu, '')
    .replace(/\s/g, '-');

const isOutside = (href: string): boolean => /^[a-z]+:/.test(href);

/** The address of a link within the help; none where it leads out of it. */
function within(href: string, topic: string): string | undefined {
  const [path = '', section] = href.split('#');
  const to = path === '' ? topic : topicOf.get(path.split('/').at(-1));
  return to && `/help/${to}${section === undefined ? '' : `#${section}`}`;
}

/** Without the names of files, which nobody who reads the help has at hand. */
const unnamed = (words: string): string =>
  words.replace(/(?<![[(/\w])docs\/([\w-]+)\.md(?:#[\w-]+)?/g, (path, name: string) =>
    topicOf.has(`${name}.md`) ? `[the help](${path})` : `the ${name} document`,
  );

function read(topic: string, words: string): Made {
  const marked = new Marked({
    renderer: {
      heading({ tokens, depth, text }: Tokens.Heading) {
        const inner = this.parser.parseInline(tokens);
        // The page has the title.
        return depth === 1 ? '' : `<h${depth} id="${slug(text)}">${inner}</h${depth}>`;
      },
      link({ href, tokens }: Tokens.Link) {
        const inner = this.parser.parseInline(tokens);
        const to = isOutside(href) ? href : within(href, topic);
        return to ? `<a href="${to}">${inner}</a>` : inner;
      },
      image: () => '',
    },
  });
  const tokens = marked.lexer(unnamed(words));
  let title = topic;
  const sections: Made['sections'] = [{ id: '', title: '', text: '' }];
  for (const token of tokens) {
    if (token.type === 'heading') {
      const { depth, text } = token as Tokens.Heading;
      if (depth === 1) title = plain(text);
      else sections.push({ id: slug(text), title: plain(text), text: '' });
    } else {
      const last = sections.at(-1);
      if (last) last.text += ` ${plain(token.raw)}`;
    }
  }
  return { id: topic, title, html: marked.parser(tokens), sections };
}

/** Words as they are searched in and shown in what is found. */
const plain = (words: string): string =>
  words
    .replace(/\[([^\]]*)\]\([^)]*\)/g, '$1')
    .replace(/[`*|#]+/g, ' ')
    .replace(/-{3,}/g, ' ')
    .replace(/\s+/g, ' ')
    .trim();
