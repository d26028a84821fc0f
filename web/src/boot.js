// @ts-check
/**
 * Before everything else: a file of the page that did not come, on a slow computer, is asked for again; the page says so when
 * that does not help, and not that it is connecting. No module, so that it needs no other file.
 */
(() => {
  const COUNT = 'rumbo.loads';
  const MOST = 4;
  const AGAIN_MS = 700;
  const tries = Number(sessionStorage.getItem(COUNT) ?? 0);

  function explain() {
    const spanish = navigator.language.startsWith('es');
    const bar = document.getElementById('notice');
    if (!bar) return;
    bar.hidden = false;
    bar.className = 'bad';
    bar.textContent = location.protocol === 'file:'
      ? (spanish ? 'Esta página no funciona como archivo: ejecuta «rumbo lab», que la abre.' : 'This page does not work as a file: run `rumbo lab`, which opens it.')
      : (spanish ? 'Faltan archivos de la página. Cárgala otra vez, o mira si rumbo sigue en marcha.' : 'Files of the page are missing. Load it again, or see whether rumbo still runs.');
  }

  addEventListener('error', ({ target }) => {
    const style = target instanceof HTMLLinkElement && target.rel === 'stylesheet';
    if (!style && !(target instanceof HTMLScriptElement)) return;
    if (location.protocol !== 'file:' && tries < MOST) {
      sessionStorage.setItem(COUNT, String(tries + 1));
      setTimeout(() => location.reload(), AGAIN_MS);
    } else if (document.readyState === 'loading') addEventListener('DOMContentLoaded', explain);
    else explain();
  }, true);
  addEventListener('load', () => {
    if ('rumbo' in window) sessionStorage.removeItem(COUNT);
  });
})();
