/** Which page the address names, and moving between pages without reloading. */

export type Route =
  | { page: 'vessels' | 'alerts' | 'mail' | 'webhooks' | 'not-found' }
  | { page: 'vessel'; id: string };

export function parseRoute(path: string): Route {
  const [first, second, ...rest] = path.split('/').filter((part) => part !== '');
  if (first === undefined) return { page: 'vessels' };
  if (second === undefined && (first === 'alerts' || first === 'mail' || first === 'webhooks')) {
    return { page: first };
  }
  if (first !== 'vessels' || rest.length > 0) return { page: 'not-found' };
  return second === undefined ? { page: 'vessels' } : { page: 'vessel', id: second };
}

export const vesselPath = (id: string): string => `/vessels/${encodeURIComponent(id)}`;
export const vesselsPath = '/';
export const alertsPath = '/alerts';
export const mailPath = '/mail';
export const webhooksPath = '/webhooks';

class RouteState {
  current = $state<Route>({ page: 'vessels' });

  /** Follows the address bar, and takes over clicks on links within the dashboard. */
  start(): () => void {
    const read = () => {
      this.current = parseRoute(location.pathname);
    };
    const click = (event: MouseEvent) => {
      if (event.defaultPrevented || event.button !== 0) return;
      if (event.metaKey || event.ctrlKey || event.shiftKey || event.altKey) return;
      const link = event.target instanceof Element ? event.target.closest('a') : null;
      if (link?.target !== '' || link.origin !== location.origin) return;
      if (link.hash !== '' && link.pathname === location.pathname) return;
      if (link.pathname.startsWith('/api/')) return;
      event.preventDefault();
      history.pushState(null, '', link.href);
      read();
      scrollTo(0, 0);
      // As after a real change of page, the keyboard starts from the top again.
      document.getElementById('content')?.focus({ preventScroll: true });
    };
    read();
    addEventListener('popstate', read);
    document.addEventListener('click', click);
    return () => {
      removeEventListener('popstate', read);
      document.removeEventListener('click', click);
    };
  }
}

export const route = new RouteState();
