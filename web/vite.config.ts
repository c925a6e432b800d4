import { svelte } from '@sveltejs/vite-plugin-svelte';
import { defineConfig } from 'vitest/config';
import { help } from './scripts/help.ts';
import { land } from './scripts/land.ts';

/** Where `npm run dev` finds a running server. */
const server = process.env['BINNACLE_URL'] ?? 'http://127.0.0.1:8080';

export default defineConfig({
  plugins: [svelte(), land(), help()],
  build: {
    target: 'es2022',
    // The content security policy allows nothing but files of our own.
    assetsInlineLimit: 0,
    // Few files rather than small ones: see below.
    cssCodeSplit: false,
    modulePreload: { polyfill: false },
    chunkSizeWarningLimit: 400,
    // The server reads in it which files a page will ask for.
    manifest: 'files.json',
    rolldownOptions: {
      // A text that nobody shows on a page is no reason to load its file.
      treeshake: { moduleSideEffects: [{ test: /src.text./, sideEffects: false }] },
      output: {
        // Without the list of pages that share it.
        chunkFileNames: ({ name }) => `assets/${name.replace(/~.*/, '')}-[hash].js`,
        // A link with 1,500 ms to and fro asks for few files rather than for small ones.
        codeSplitting: {
          groups: [
            { name: 'first', tags: ['$initial'], priority: 1 },
            {
              name: 'parts',
              test: /\/src\//,
              minShareCount: 2,
              entriesAware: true,
              entriesAwareMergeThreshold: 24_000,
            },
          ],
        },
      },
    },
  },
  server: { proxy: { '/api': { target: server, changeOrigin: true } } },
  test: { include: ['src/**/*.test.ts'], environment: 'node' },
});
