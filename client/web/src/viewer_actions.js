/** @param {string} hash Of the view. @param {(text: string) => void} say */
export async function copy_link(hash, say) {
  const address = new URL(hash, location.href).href;
  try {
    await navigator.clipboard.writeText(address);
    say('Link to this view copied');
  } catch {
    say('The browser did not allow copying: the address bar holds the link');
  }
}

/** @param {(text: string) => void} say */
export async function toggle_fullscreen(say) {
  try {
    await (document.fullscreenElement ? document.exitFullscreen() : document.documentElement.requestFullscreen());
  } catch {
    say('The browser did not allow full screen');
  }
}
