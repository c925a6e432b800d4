import type * as en from '../platform';
import type { Translation } from './translation';

export const platform: Translation<typeof en.platform> = {
  lead: 'Las compañías de este servidor. Lo que hacen los buques de una flota es asunto de su operador y no se ve aquí.',
  nameMissing: 'La compañía necesita un nombre.',
  entering: 'Registrando…',
  since: (day) => `desde ${day}`,
  health: {
    title: 'Estado',
    lead: 'Si se pueden atender peticiones. Las cifras para Prometheus están en /metrics.',
    ready: 'En servicio.',
    asOf: (when) => `El servidor y la base de datos respondieron a las ${when}.`,
    notReady:
      'El servidor responde, pero no puede atender peticiones: su base de datos no responde.',
  },
  operators: {
    title: 'Operadores',
    lead: 'Compañías con flota.',
    none: 'Todavía no hay operadores.',
    name: 'Nombre del operador',
    submit: 'Registrar el operador',
    entered: (name) => `${name} está registrado. Ahora falta invitar a su primer usuario.`,
    invite: (name) => `Invitar a un administrador de ${name}`,
  },
  firms: {
    title: 'Empresas de compensación',
    lead: 'Compañías que compensan agujas.',
    none: 'Todavía no hay empresas.',
    name: 'Nombre de la empresa',
    submit: 'Registrar la empresa',
    entered: (name) => `${name} está registrada. Ahora falta invitar a su primer compensador.`,
    invite: (name) => `Invitar a un compensador de ${name}`,
  },
  together: {
    title: 'Quién trabaja con quién',
    lead: 'Un operador puede ofrecer sus órdenes a las empresas con las que trabaja. Las órdenes que tiene una empresa siguen siendo suyas.',
    operator: 'Operador',
    firm: 'Empresa',
    choose: 'Elegir…',
    missing: 'Elegir un operador y una empresa.',
    submit: 'Trabajan juntos',
    end: 'Ya no trabajan juntos',
    done: (operator, firm) => `${operator} trabaja con ${firm}.`,
    ended: (operator, firm) => `${operator} ya no trabaja con ${firm}.`,
  },
};
