/** Whether everyone can use a page: axe-core's rules of WCAG 2.2 A and AA, and its best practices. */
import { createRequire } from 'node:module';

const source = createRequire(import.meta.url).resolve('axe-core/axe.min.js');
const tags = ['wcag2a', 'wcag2aa', 'wcag21a', 'wcag21aa', 'wcag22aa', 'best-practice'];

/** What axe finds on the page as it is, in a line each; nothing where all is well. */
export async function findings(page) {
  // As by the developer's tools: the page's own policy lets no other script in.
  await page.evaluate(await script());
  const { violations } = await page.evaluate(
    (runOnly) => window.axe.run(document, { runOnly, resultTypes: ['violations'] }),
    tags,
  );
  return violations.flatMap(({ id, help, nodes }) =>
    nodes.slice(0, 3).map(({ target, failureSummary }) => {
      const why = failureSummary.split('\n').slice(1, 3).join(' ').trim();
      return `${id}: ${help}: ${target.join(' ')} (${why})`;
    }),
  );
}

async function script() {
  const { readFile } = await import('node:fs/promises');
  return readFile(source, 'utf8');
}
