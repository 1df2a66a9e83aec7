import { defineConfig } from 'vite';

// Relative addresses, so that the files work wherever the engine serves them; no inlined scripts or
// data, because the page's content security policy forbids them.
export default defineConfig({
    base: './',
    build: {
        target: 'es2021',
        assetsInlineLimit: 0,
        modulePreload: { polyfill: false },
        chunkSizeWarningLimit: 1200,
    },
});
