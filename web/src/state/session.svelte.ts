/** Who is signed in. `unknown` until the server has been asked. */

import { findMe, signIn, signOut, whenSignedOut } from '../api/client';
import { Problem } from '../api/problem';
import type { Me } from '../api/types';

type Session =
  | { status: 'unknown' }
  | { status: 'failed'; problem: Problem }
  | { status: 'out'; ended: boolean }
  | { status: 'in'; me: Me };

class SessionState {
  current = $state<Session>({ status: 'unknown' });

  get me(): Me | null {
    return this.current.status === 'in' ? this.current.me : null;
  }

  get isAdmin(): boolean {
    return this.me?.role === 'admin';
  }

  async find(): Promise<void> {
    try {
      this.current = { status: 'in', me: await findMe() };
    } catch (error) {
      if (!(error instanceof Problem)) throw error;
      this.current =
        error.status === 401
          ? { status: 'out', ended: false }
          : { status: 'failed', problem: error };
    }
  }

  async signIn(email: string, password: string): Promise<void> {
    this.current = { status: 'in', me: await signIn(email, password) };
  }

  async signOut(): Promise<void> {
    await signOut().catch((error: unknown) => {
      // A session that has already ended is signed out all the same.
      if (!(error instanceof Problem && error.status === 401)) throw error;
    });
    this.current = { status: 'out', ended: false };
  }

  ended(): void {
    if (this.current.status === 'in') this.current = { status: 'out', ended: true };
  }
}

export const session = new SessionState();
whenSignedOut(() => {
  session.ended();
});
