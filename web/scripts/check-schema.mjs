/**
 * Fails when src/api/schema.d.ts is not what server/openapi.json generates:
 * the dashboard's types must be those of the server it is built with.
 */
import { readFile } from 'node:fs/promises';
import openapiTS, { astToString, COMMENT_HEADER } from 'openapi-typescript';

const source = new URL('../../server/openapi.json', import.meta.url);
const target = new URL('../src/api/schema.d.ts', import.meta.url);

const expected = COMMENT_HEADER + astToString(await openapiTS(source));
const found = await readFile(target, 'utf8');
if (found !== expected) {
  console.error('src/api/schema.d.ts is not up to date: run `npm run schema` and commit it');
  process.exit(1);
}
