/**
 * Tells pages that the browser took out of its own cache (nothing was transferred) from those the server answered.
 * @param {import('./page_ledger.js').PageLedger} ledger @param {AbortSignal} until
 */
export function watch_cache(ledger, until) {
  const observer = new PerformanceObserver((list) => {
    for (const entry of /** @type {PerformanceResourceTiming[]} */ (list.getEntries())) {
      if (entry.transferSize === 0 && entry.decodedBodySize > 0) ledger.came_from_cache(entry.name);
    }
  });
  observer.observe({type: 'resource', buffered: false});
  until.addEventListener('abort', () => observer.disconnect());
}
