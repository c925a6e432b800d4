import type * as en from '../trust';
import type { Translation } from './translation';

export const trust: Translation<typeof en.trust> = {
  title: 'Hasta dónde fiarse de la curva',
  lead: 'La banda del 95 %: diecinueve veces de cada veinte el desvío no se aparta más que esto.',
  hereTitle: 'En estas aguas',
  thereTitle: 'En el lugar elegido',
  here: (worst, least, best) => `en el peor caso, a ${worst}; ${least} en el mejor, a ${best}.`,
  hereEven: 'a todos los rumbos.',
  hereNone: 'Este modelo llegó sin errores: no se sabe cuánto puede apartarse.',
  elsewhereTitle: 'En otras aguas, hasta',
  elsewhere: (limit, good, worst, at) =>
    `Alrededor de ${limit} o mejor a todos los rumbos ${good} de latitud magnética; en otras partes hasta ${worst}, lo peor ${at}.`,
  everywhereGood: (limit, all) =>
    `Alrededor de ${limit} o mejor a todos los rumbos dondequiera que navegan buques: ${all} de latitud magnética.`,
  nowhereGood: (limit, at) =>
    `Todavía ninguna latitud magnética se conoce a ${limit} a todos los rumbos. Lo peor está ${at}.`,
  between: (from, to) => `entre ${from} y ${to}`,
  worthTitle: 'Sus muestras valen',
  worth: (samples, effective) =>
    `${samples} muestras, que valen ${effective} con errores independientes: los errores de una giroscópica duran horas y días, los de la declinación decenas de millas, de modo que las muestras se repiten.`,
  priorTitle: 'El modelo partió de',
  priorSisters: (ships) => `${ships} buques gemelos`,
  priorOfSisters: (name, published) =>
    `Clase «${name}», según se publicó el ${published}. Las muestras propias del buque se suman a ello, y siguen siendo posibles buques distintos de esta clase.`,
  priorFleet: (ships) => `${ships} buques de esta flota`,
  priorOfFleet: (published) =>
    `Según se publicó el ${published}. Las muestras propias del buque se suman a ello, y siguen siendo posibles buques distintos de esta flota.`,
  priorAtLarge: 'Buques en general',
  priorUsual: 'Partió de lo habitual en los buques, sin otros de esta flota.',
  priorTooFew:
    'En el primer análisis se conocían muy pocos buques más de esta flota, así que partió de lo habitual en los buques.',
  predictionsTitle: 'Previsto antes de leerse',
  predictions: (inside, watches) => `${inside} de ${watches}`,
  predictionsHeld: (from, to) =>
    `Tantas de sus últimas guardias cayeron dentro de la banda del 95 % trazada antes de su primera lectura. En una banda fiel caen de ${from} a ${to}.`,
  predictionsShort: (from, to, factor) =>
    `Tantas de sus últimas guardias cayeron dentro de la banda del 95 % trazada antes de su primera lectura. En una banda fiel caerían de ${from} a ${to}: por eso su banda se traza ${factor} veces más ancha de lo que daría el modelo solo.`,
  byCourse:
    'Este modelo se apoya solo en el rumbo sobre el fondo, porque el buque no tiene giroscópica ni compás satelital. La corriente y el viento se estiman, y la banda es ancha. Tomar azimutes, y no gobernar con él sin ellos.',
  referencesTitle: 'Giroscópica y compás satelital',
  apart: (angle) => `${angle} de diferencia`,
  gyroAhead: (angle, pairs) =>
    `La giroscópica suele marcar ${angle} más que el compás satelital (${pairs} muestras con ambos).`,
  gyroBehind: (angle, pairs) =>
    `La giroscópica suele marcar ${angle} menos que el compás satelital (${pairs} muestras con ambos).`,
  constantLeft: (band) =>
    `Ningún rumbo revela cuál acierta: todas las bandas incluyen ${band} por ello.`,
  oneReference: 'Solo una',
  oneReferenceLong: (band) =>
    `Ninguna muestra llegó con ambas, así que ninguna comprueba a la otra; todas las bandas incluyen ${band} por un error constante de la referencia.`,
  notCompared: 'Sin comparar',
  notComparedLong: (pairs, band) =>
    `Solo ${pairs} muestras llegaron con ambas; todas las bandas incluyen ${band} por un error constante de la referencia.`,
  droppedTitle: 'Lecturas no dadas por buenas',
  dropped: (gyro, satellite) =>
    `Se dejó fuera la giroscópica en ${gyro} muestras y el compás satelital en ${satellite}.`,
  droppedWhy: (beyond) =>
    `Se considera que una ha fallado cuando se quedó parada mientras el buque giraba, o cuando ambas se apartaron más de ${beyond} de su diferencia habitual. Entonces decide la aguja magnética; donde no puede, se dejan fuera las dos.`,
  droppedStuck: 'Se quedó parada mientras el buque giraba.',
  oneMagneticLatitude:
    'Sus muestras son de un intervalo de latitudes magnéticas demasiado estrecho para separar el magnetismo permanente del inducido. La curva es buena donde ha estado el buque; lejos de allí se apoya en lo habitual en los buques hasta que haya navegado allí.',
  fewSamples:
    'Sus latitudes separarían el magnetismo permanente del inducido, pero sus muestras son todavía muy pocas. La curva es buena donde ha estado el buque; en otras partes se apoya en lo habitual en los buques hasta que lleguen más muestras, para lo que basta seguir navegando.',
  noTimes:
    'Las filas no tienen hora, o la comparten, así que nadie sabe cuáles comparten un mismo error de la giroscópica. La banda toma las filas a rumbos parecidos como de medio día.',
  largeResiduals: (residual) =>
    `El desvío medido y el previsto suelen diferir ${residual}, más de lo que dejan instrumentos en buen estado. Comprobar aguja, giroscópica y compás satelital, y qué entrada se toma por cuál, antes de fiarse de estas cifras.`,
  variationUnproven: (zero, mistake) =>
    `El cero de la aguja parece apartarse ${zero}. También lo parecería si algo estuviera mal en el rumbo tomado por verdadero: ${mistake}. Comprobarlo a bordo, o tomar una demora del sol. La banda admite ambas cosas.`,
  longGap: (days, last) =>
    `Antes de las últimas muestras no hubo ninguna en ${days} días. La curva es para ${last}, y su banda admite lo que un buque puede cambiar en ese tiempo.`,
  unknown: 'Esta página no conoce una de las advertencias de este modelo: cargarla de nuevo.',
  weakField: (h) =>
    `Algunas muestras son de aguas con un campo horizontal de solo ${h}. Allí una aguja es perezosa, campos pequeños la perturban mucho y su rumbo debe comprobarse a menudo.`,
  tableTitle: 'La banda por latitud magnética',
  caption: 'Semiancho de la banda del 95 % al peor rumbo, por latitud magnética de norte a sur',
  waters: 'Latitud magnética',
  band: 'Hasta',
  sailed: 'hay muestras de allí',
  mark: 'aquí',
  noAnswer: 'sin respuesta',
  noAnswerLong: 'Sin respuesta: a algún rumbo el magnetismo del buque superaría allí al terrestre.',
};

export const refusal: Translation<typeof en.refusal> = {
  withdrawn: (since, reason) =>
    `La última tablilla no vale desde ${since} (${reason}): no gobernar con ella.`,
  todo: 'Qué hacer',
  tooFewSamples: (found, needed) =>
    `Hasta ahora sirven ${found} muestras; hacen falta al menos ${needed}.`,
  leftOutFor: (samples, kind) => `${samples} por «${kind}»`,
  leftOut: (kinds) =>
    `Anotaciones del diario dejan fuera más muestras: ${kinds}. Si alguna ha terminado, anotar su final en el diario.`,
  tooFewSamplesTodo:
    'Seguir navegando: el agente toma una muestra cada unos diez minutos a rumbo estable y con velocidad, lejos del atraque. Si llegan pocas, lo que fue de las ventanas de diez segundos figura en «A bordo», con los motivos.',
  noReference: (readings) =>
    `Ninguna de las ${readings} muestras tiene un rumbo de giroscópica o compás satelital con el que contrastar la aguja.`,
  noReferenceTodo:
    'Comprobar a bordo que hay conectada una giroscópica o un compás satelital, y qué sentencia se toma por él.',
  noSteadyCourse: (readings, found, needed, tooSlow, least, turning) =>
    `Ninguna muestra tiene un rumbo de giroscópica o compás satelital. El rumbo sobre el fondo indica el rumbo en ${found} de ${readings} muestras; hacen falta al menos ${needed}. ${tooSlow} están por debajo de ${least} nudos, ${turning} en un giro o justo después.`,
  noSteadyCourseTodo:
    'Gobernar navegando a rumbos rectos distintos, o conectar una giroscópica o un compás satelital.',
  noWeight: (samples) => `El peso es 0 en las ${samples} muestras.`,
  noWeightTodo: 'Dar un peso superior a 0 a las filas que deban contar.',
  contradictory: (residual, allowed) =>
    `El desvío medido y el previsto difieren ${residual}, cuando ningún instrumento deja más de ${allowed}: ningún magnetismo de buque explica estas muestras.`,
  contradictoryTodo:
    'Comprobar a bordo qué entrada se toma por la aguja y cuál por la giroscópica, y en un archivo el signo de la declinación, que es positiva al este.',
  tooFewHeadings: (found, needed, gap, allowed) =>
    `Hay muestras en ${found} de 24 sectores de 15°, con un hueco de ${gap} entre ellas. Hacen falta al menos ${needed} sectores y ningún hueco mayor de ${allowed}.`,
  missing: (ranges) => `Faltan: ${ranges}.`,
  tooFewHeadingsTodo:
    'Gobernar a los rumbos que faltan, marcados como vacíos en «Cobertura»: bastan diez minutos estables a cada uno, por ejemplo mientras se espera al práctico o el atraque, o en el viaje de vuelta.',
  fieldTooWeak: (strongest, needed) =>
    `Todas las muestras son de aguas con un campo horizontal de ${strongest} como máximo; una aguja magnética necesita ${needed} o más para gobernar con ella.`,
  fieldTooWeakTodo:
    'La aguja no tiene nada malo. El modelo llega con muestras de latitudes magnéticas más bajas; hasta entonces gobernar con giroscópica o compás satelital.',
  ambiguousHeadings: (h) =>
    `Las muestras exigen tanto magnetismo que, con un campo horizontal de ${h}, un rumbo de aguja correspondería a varios rumbos magnéticos.`,
  ambiguousHeadingsTodo:
    'No fiarse de esta aguja. Buscar correctores que falten o estén al revés y acero cerca de la bitácora, comprobar que el agente lee el instrumento correcto y hacer compensar la aguja.',
  oneMagneticLatitude:
    'Todas las muestras son de una sola latitud magnética, donde no se pueden separar el magnetismo permanente y el inducido.',
  oneMagneticLatitudeTodo: 'Un viaje a otra latitud magnética los separa.',
  referencesDisagree: (apart, allowed) =>
    `La giroscópica y el compás satelital difieren siempre ${apart}; ${allowed} es lo máximo que explica la alineación. Uno de los dos está mal, y los rumbos no dicen cuál.`,
  referencesDisagreeTodo:
    'Comprobar ambos con una enfilación o la demora del sol: el compás satelital por la alineación y el offset de su antena, la giroscópica por sus ajustes de latitud y velocidad. Corregir el que esté mal, o dejarlo fuera a bordo; el modelo llega con las muestras posteriores.',
  referenceStuck: (readings) =>
    `La única referencia se quedó parada en ${readings} lecturas mientras la aguja giraba: está bloqueada, o se toma otra fuente por ella.`,
  referenceStuckTodo:
    'Comprobar a bordo qué instrumento y qué sentencia se toma por la giroscópica o el compás satelital, y que sigue al buque al girar. El modelo llega con las muestras posteriores.',
  referenceIsCompass: (samples, scatter, least) =>
    `El rumbo tomado por verdadero es el de la propia aguja. En ${samples} muestras su diferencia solo se dispersa ${scatter}, cuando dos instrumentos con estas cifras dejan al menos ${least}.`,
  referenceIsCompassTodo:
    'Comprobar a bordo qué instrumento y qué sentencia se toma por la giroscópica o el compás satelital. No debe ser un rumbo calculado con la aguja magnética y la declinación.',
  variationMistaken: (mistake, residual, explained) =>
    `El rumbo tomado por verdadero no lo es: ${mistake}. Tal como está, ningún magnetismo de buque se ajusta a las muestras a menos de ${residual}; sin este error uno se ajusta a ${explained}.`,
  variationMistakes: {
    missing: 'le falta la declinación, es magnético',
    wrong_sign: 'lleva la declinación con el signo equivocado',
    doubled: 'lleva la declinación dos veces',
  },
  variationMistakenTodo:
    'Comprobar a bordo qué instrumento da el rumbo verdadero y cómo suma la declinación: el rumbo verdadero es el magnético más la declinación, positiva al este. Las muestras tomadas hasta ahora no sirven.',
  fewSamplesUsed: (used, found) =>
    `Solo ${used} de ${found} muestras concuerdan con un mismo magnetismo de buque.`,
  fewSamplesUsedTodo:
    'Comprobar si durante una parte del tiempo la aguja se movió o la giroscópica estaba mal, y comunicarlo en el diario. Un archivo conviene dividirlo ahí.',
  modelDoesNotExplain: (residual, allowed) =>
    `El mejor modelo se aparta ${residual} de sus propias muestras. Una aguja con un desvío superior a ${allowed} debe compensarse.`,
  modelDoesNotExplainTodo:
    'Comprobar si entretanto cambiaron la aguja, sus correctores o la giroscópica, y comunicarlo en el diario.',
  notConverged: 'Las muestras se contradicen entre sí, o contradicen a cualquier buque.',
  notConvergedTodo:
    'Comprobar a bordo que aguja, giroscópica y compás satelital se toman de los instrumentos correctos, y comunicar en el diario lo que cambió entretanto el magnetismo del buque: carga, reparaciones, rayos, correctores.',
  none: 'Todavía no se ha analizado ninguna muestra.',
  noneTodo:
    'Hacer dar de alta el agente a bordo si no lo está. Cuando el buque está en la mar, las muestras llegan con sus envíos.',
};
