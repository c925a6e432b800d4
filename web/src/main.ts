import { mount } from 'svelte';
import App from './App.svelte';
import './app.css';
import { keepFiles } from './offline';
import * as text from './text';
import { loadLanguage } from './text/language';

const target = document.getElementById('app');
if (!target) throw new Error(text.noMountPoint);
void loadLanguage().then(() => mount(App, { target }));
keepFiles();
