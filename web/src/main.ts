import { mount } from 'svelte';
import App from './App.svelte';
import './app.css';
import { keepFiles } from './offline';
import * as text from './text';

const target = document.getElementById('app');
if (!target) throw new Error(text.noMountPoint);
mount(App, { target });
keepFiles();
