"use strict";(()=>{var VIRIDIS=[[68,1,84],[71,44,122],[59,81,139],[44,113,142],[33,144,141],[39,173,129],[92,200,99],[170,220,50],[253,231,37]];function viridis(value){let position=value>0?Math.min(value,1)*(VIRIDIS.length-1):0,i=Math.min(Math.floor(position),VIRIDIS.length-2),t=position-i;return[0,1,2].map(c=>Math.round(VIRIDIS[i][c]*(1-t)+VIRIDIS[i+1][c]*t))}function diverging(value){let t=Math.min(Math.abs(value),1),end=value<0?[0,114,178]:[230,130,0];return[0,1,2].map(c=>Math.round(236*(1-t)+end[c]*t))}function mapTone(x){return x>.5?.5-.5*Math.expm1(1-2*x):x>0?x:0}function encodeSrgb(x){let y=mapTone(x);return Math.round(255*(y<=.0031308?12.92*y:1.055*y**(1/2.4)-.055))}function readTheme(){let style=getComputedStyle(document.documentElement);function colour(name){return style.getPropertyValue(name).trim()}return{ink:colour("--ink"),soft:colour("--soft"),faint:colour("--faint"),paper:colour("--paper"),series:[colour("--first"),colour("--second"),colour("--third")]}}function readHex(colour){let number=parseInt(colour.slice(1),16);return[(number>>16)/255,(number>>8&255)/255,(number&255)/255]}function quoteWord(word){return/^[\w@%+=:,./-]+$/.test(word)?word:`'${word.replaceAll("'","'\\''")}'`}function nameMaterials(materials){return materials.map(entry=>quoteWord(entry.text??entry.name)).join(" ")}function nameMeshScene(mesh,material,normals,options){return`printf '%s\\n' ${["[[material]]",'name = "material"',`brdf = ${JSON.stringify(material.text??material.name)}`,"[[object]]",'shape = "mesh"',`file = ${JSON.stringify(mesh.text??mesh.name)}`,'material = "material"',`smooth = ${normals==="smooth"}`].map(quoteWord).join(" ")} > scene.toml && merlkit render scene.toml ${options} --size 512x512 -o mesh`}var FONT="12px system-ui, sans-serif",DASHES=[[],[8,4],[2,3]];function makeTicks({min,max,isLog}){let ticks=[];if(isLog){let[low,high]=[Math.ceil(Math.log10(min)-1e-9),Math.floor(Math.log10(max)+1e-9)],step2=Math.max(1,Math.ceil((high-low)/6));for(let power=low;power<=high;power+=step2)ticks.push(10**power);high-low<2&&ticks.push(...[low-1,low,high].flatMap(power=>[2*10**power,5*10**power]));let within=[...new Set(ticks)].filter(tick=>tick>=min&&tick<=max);return within.length<3?makeTicks({label:"",min,max}):within}let rough=(max-min)/6,unit=10**Math.floor(Math.log10(rough)),step=unit*([1,2,5,10].find(factor=>factor*unit>=rough)??10);for(let i=Math.ceil(min/step-1e-9);i*step<=max+1e-9*step;i++)ticks.push(i*step);return ticks}function writeTick(value){let size=Math.abs(value);return size!==0&&(size<.001||size>=1e5)?value.toExponential(0).replace("e+","e"):String(Number(value.toPrecision(4)))}function placeOnAxis({min,max,isLog,isRoot},value){return isRoot?Math.sqrt(Math.max(value,0)/max):isLog?(Math.log(Math.max(value,min))-Math.log(min))/(Math.log(max)-Math.log(min)):(value-min)/(max-min)}function findValue({min,max,isLog},position){return isLog?min*(max/min)**position:min+(max-min)*position}function cutAxis(axis,from,to){return{...axis,min:findValue(axis,from),max:findValue(axis,to)}}function drawAxes(context,box,x,y,theme){function place2(px,py){return[box.left+box.width*placeOnAxis(x,px),box.top+box.height*(1-placeOnAxis(y,py))]}context.font=FONT,context.fillStyle=theme.ink,context.strokeStyle=theme.faint,context.lineWidth=.5,context.setLineDash([]),context.textAlign="center",context.textBaseline="top";for(let tick of makeTicks(x)){let[across]=place2(tick,y.min);drawLine(context,[across,box.top],[across,box.top+box.height]),context.fillText(writeTick(tick),across,box.top+box.height+5)}context.fillText(x.label,box.left+box.width/2,box.top+box.height+21),context.textAlign="right",context.textBaseline="middle";for(let tick of makeTicks(y)){let[,down]=place2(x.min,tick);drawLine(context,[box.left,down],[box.left+box.width,down]),context.fillText(writeTick(tick),box.left-5,down)}return context.textAlign="left",context.textBaseline="bottom",context.fillText(y.label,Math.max(box.left-44,2),box.top-8),context.textBaseline="alphabetic",place2}function drawLine(context,from,to){context.beginPath(),context.moveTo(...from),context.lineTo(...to),context.stroke()}function drawCurve(context,curve,place2,box){context.save(),context.beginPath(),context.rect(box.left,box.top,box.width,box.height),context.clip(),context.strokeStyle=curve.colour,context.lineWidth=2,context.lineJoin="round",context.setLineDash(curve.dashes??[]),context.beginPath();for(let[x,y]of curve.points)context.lineTo(...place2(x,y));context.stroke(),context.restore()}var ROW=17,FIRST_ROW=12;function measureLegend(rows){return FIRST_ROW+ROW*rows}function drawLegend(context,curves,box,theme){context.font=FONT,context.textAlign="right",context.textBaseline="middle",curves.forEach((curve,i)=>{let down=box.top+FIRST_ROW+ROW*i,right=box.left+box.width-36;context.fillStyle=theme.paper,context.globalAlpha=.75;let name=curve.name.length>30?`${curve.name.slice(0,29)}…`:curve.name,across=context.measureText(name).width;context.fillRect(right-across-3,down-8,across+39,16),context.globalAlpha=1,context.fillStyle=theme.ink,context.fillText(name,right,down),context.strokeStyle=curve.colour,context.lineWidth=2,context.setLineDash(curve.dashes??[]),drawLine(context,[right+6,down],[right+34,down])}),context.setLineDash([]),context.textBaseline="alphabetic"}var MAGIC="MKXPLOR1",KINDS={f32:Float32Array,u32:Uint32Array,u16:Uint16Array,u8:Uint8Array},MOST_KEPT=64e6;function openSource(){return document.querySelector("meta[name=merlkit-mode]")?.content==="stored"?openStored():openLive()}function readToken(){return new URLSearchParams(location.hash.slice(1)).get("token")??""}function openLive(){let headers={"X-Merlkit-Token":readToken()};async function request(key,options){let response=await fetch(`/${key}`,{...options,headers});if(!response.ok)throw new Error((await response.text()).trim()||`the server answers ${response.status}`);return response}async function post(path,name,body){return(await request(`api/v1/${path}?name=${encodeURIComponent(name)}`,{method:"POST",body})).json()}return{isStored:!1,holds:()=>!0,bytes:async key=>(await request(key,{})).arrayBuffer(),send:(name,file)=>post("materials",name,file),sendMesh:(name,file)=>post("meshes",name,file)}}function openStored(){let data=document.getElementById("data"),answers=JSON.parse(data?.textContent??"{}"),isCompressed=data?.dataset.encoding==="gzip";return{isStored:!0,holds:key=>Object.hasOwn(answers,key),bytes:async key=>{if(!Object.hasOwn(answers,key))throw new Error("This exported page does not hold that. Run merlkit explore to see it.");let bytes=decodeBase64(answers[key]);return isCompressed?decompress(bytes):bytes},send:refuseFile,sendMesh:refuseFile}}async function refuseFile(){throw new Error("An exported page loads no files. Run merlkit explore to load them.")}function decodeBase64(text){let characters=atob(text),bytes=new Uint8Array(characters.length);for(let i=0;i<bytes.length;i++)bytes[i]=characters.charCodeAt(i);return bytes.buffer}function decompress(bytes){let stream=new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));return new Response(stream).arrayBuffer()}function parseAnswer(buffer){let view=new DataView(buffer),magic=buffer.byteLength>=12?new TextDecoder().decode(new Uint8Array(buffer,0,8)):"";if(magic!==MAGIC)throw new Error(`an answer starts with "${magic}" instead of ${MAGIC}: page and server differ in version`);let length=view.getUint32(8,!0),members=JSON.parse(new TextDecoder().decode(new Uint8Array(buffer,12,length))),arrays={},offset=alignToEight(12+length);for(let{name,type,shape}of members.arrays){let count=shape.reduce((product,side)=>product*side,1),array=new KINDS[type](buffer,offset,count);arrays[name]=array,offset=alignToEight(offset+array.byteLength)}return{members,arrays}}function alignToEight(offset){return Math.ceil(offset/8)*8}var kept=new Map;function keep(source,key,parse){let known=kept.get(key);if(known)return kept.delete(key),kept.set(key,known),known.answer;let made={answer:Promise.resolve(),bytes:0},answer=source.bytes(key).then(buffer=>(made.bytes=buffer.byteLength,forgetOldest(),parse(buffer)));return made.answer=answer,kept.set(key,made),answer.catch(()=>kept.delete(key)),answer}function forgetOldest(){let total=0;for(let[key,{bytes}]of[...kept].reverse())total+=bytes,total>MOST_KEPT&&bytes>0&&kept.delete(key)}function askBinary(source,key){return keep(source,key,parseAnswer)}function askJson(source,key){return keep(source,key,buffer=>JSON.parse(new TextDecoder().decode(buffer)))}function makeKey(path,parameters){let query=parameters.map(([name,value])=>`${name}=${encodeURIComponent(value)}`);return`api/v1/${path}${query.length?`?${query.join("&")}`:""}`}function openGpu(){let canvas=document.createElement("canvas"),gl=canvas.getContext("webgl2",{alpha:!1,antialias:!0,depth:!0});if(!gl)return null;let sums2=null;return gl.getExtension("EXT_color_buffer_half_float")&&(sums2=gl.RGBA16F),gl.getExtension("EXT_color_buffer_float")&&(sums2=gl.RGBA32F),{gl,canvas,sums:sums2}}var COVER=`#version 300 es
void main() {
    vec2 corner = vec2(float((gl_VertexID << 1) & 2), float(gl_VertexID & 2));
    gl_Position = vec4(2.0 * corner - 1.0, 0.0, 1.0);
}
`;function beginProgram(gl,vertex,fragment){let program3=gl.createProgram(),shaders=[];for(let[kind,text]of[[gl.VERTEX_SHADER,vertex],[gl.FRAGMENT_SHADER,fragment]]){let shader=gl.createShader(kind);gl.shaderSource(shader,text),gl.compileShader(shader),gl.attachShader(program3,shader),shaders.push(shader)}return gl.linkProgram(program3),{program:program3,shaders}}function finishProgram(gl,{program:program3,shaders}){if(!gl.getProgramParameter(program3,gl.LINK_STATUS)){let logs=[gl.getProgramInfoLog(program3),...shaders.map(shader=>gl.getShaderInfoLog(shader))];throw new Error(`a shader does not compile: ${logs.filter(Boolean).join(" ")}`)}for(let shader of shaders)gl.deleteShader(shader);let uniforms={},count=gl.getProgramParameter(program3,gl.ACTIVE_UNIFORMS);for(let i=0;i<count;i++){let{name}=gl.getActiveUniform(program3,i);uniforms[name]=gl.getUniformLocation(program3,name)}return{program:program3,uniforms}}function makeTexture(gl,[width,height],[internal,format,type],data){let texture=gl.createTexture();gl.bindTexture(gl.TEXTURE_2D,texture),gl.pixelStorei(gl.UNPACK_ALIGNMENT,1),gl.texImage2D(gl.TEXTURE_2D,0,internal,width,height,0,format,type,data);for(let name of[gl.TEXTURE_MIN_FILTER,gl.TEXTURE_MAG_FILTER])gl.texParameteri(gl.TEXTURE_2D,name,gl.NEAREST);for(let name of[gl.TEXTURE_WRAP_S,gl.TEXTURE_WRAP_T])gl.texParameteri(gl.TEXTURE_2D,name,gl.CLAMP_TO_EDGE);return texture}function makeWordTexture(gl,words,width){let height=Math.max(1,Math.ceil(words.length/width)),padded=words;return words.length!==width*height&&(padded=new Uint32Array(width*height),padded.set(words)),makeTexture(gl,[width,height],[gl.R32UI,gl.RED_INTEGER,gl.UNSIGNED_INT],padded)}function bindTextures(gl,{uniforms},textures){let unit=0;for(let[name,texture]of Object.entries(textures))uniforms[name]&&(gl.activeTexture(gl.TEXTURE0+unit),gl.bindTexture(name==="grid"?gl.TEXTURE_3D:gl.TEXTURE_2D,texture),gl.uniform1i(uniforms[name],unit),unit+=1)}function beginPicture({gl,canvas},width,height){canvas.width<width&&(canvas.width=width),canvas.height<height&&(canvas.height=height),gl.bindFramebuffer(gl.FRAMEBUFFER,null),gl.viewport(0,0,width,height)}function copyPicture(gpu,[width,height],to,box){to.drawImage(gpu.canvas,0,gpu.canvas.height-height,width,height,...box)}var layers_default=`#version 300 es
// Layers with one solid each, the nearest on top: it lets some of the next one through. The farthest hides the paper.
precision highp float;
uniform highp sampler2D colour0;
uniform highp sampler2D colour1;
uniform highp sampler2D colour2;
uniform highp sampler2D depth0;
uniform highp sampler2D depth1;
uniform highp sampler2D depth2;
uniform vec3 paper;
uniform int fineness;
uniform int count;
out vec4 painted;

// What a solid hides of those behind it.
const float OPACITY = 0.62;

// Puts the farther of two layers first; their depths are in the fourth member.
void sort_pair(inout vec4 far, inout vec4 near)
{
    if (far.w < near.w) {
        vec4 swapped = far;
        far = near;
        near = swapped;
    }
}

// Puts a layer over what is behind it. A depth of 1 is that of no solid.
vec3 cover(vec3 behind, vec4 layer, bool is_first)
{
    if (layer.w >= 1.0) {
        return behind;
    }
    return is_first ? layer.rgb : mix(behind, layer.rgb, OPACITY);
}

vec3 blend(ivec2 texel)
{
    vec4 a = vec4(texelFetch(colour0, texel, 0).rgb, texelFetch(depth0, texel, 0).r);
    vec4 b = vec4(texelFetch(colour1, texel, 0).rgb, texelFetch(depth1, texel, 0).r);
    vec4 c = vec4(texelFetch(colour2, texel, 0).rgb, texelFetch(depth2, texel, 0).r);
    b.w = count > 1 ? b.w : 1.0;
    c.w = count > 2 ? c.w : 1.0;
    sort_pair(a, b);
    sort_pair(b, c);
    sort_pair(a, b);
    vec3 light = cover(paper, a, true);
    light = cover(light, b, a.w >= 1.0);
    return cover(light, c, b.w >= 1.0);
}

void main()
{
    ivec2 corner = ivec2(gl_FragCoord.xy) * fineness;
    vec3 sum = vec3(0.0);
    for (int y = 0; y < fineness; y++) {
        for (int x = 0; x < fineness; x++) {
            sum += blend(corner + ivec2(x, y));
        }
    }
    painted = vec4(sum / float(fineness * fineness), 1.0);
}
`;var MOST=3,FINENESS=[2,4],USUAL=1200,WIDEST=4096;function chooseFineness(side){let[least,most]=FINENESS;return least*side>WIDEST?1:Math.min(Math.max(Math.floor(USUAL/side),least),most)}var layers=null,program=null;function makeLayer(gl,size){let colour=makeTexture(gl,size,[gl.RGBA8,gl.RGBA,gl.UNSIGNED_BYTE],null),depth=makeTexture(gl,size,[gl.DEPTH_COMPONENT24,gl.DEPTH_COMPONENT,gl.UNSIGNED_INT],null),frame=gl.createFramebuffer();return gl.bindFramebuffer(gl.FRAMEBUFFER,frame),gl.framebufferTexture2D(gl.FRAMEBUFFER,gl.COLOR_ATTACHMENT0,gl.TEXTURE_2D,colour,0),gl.framebufferTexture2D(gl.FRAMEBUFFER,gl.DEPTH_ATTACHMENT,gl.TEXTURE_2D,depth,0),{frame,colour,depth}}function findLayers(gl,size,count){if(layers?.size[0]===size[0]&&layers.size[1]===size[1]&&layers.all.length>=count)return layers.all;for(let{frame,colour,depth}of layers?.all??[])gl.deleteFramebuffer(frame),gl.deleteTexture(colour),gl.deleteTexture(depth);return layers={size,all:Array.from({length:count},()=>makeLayer(gl,size))},layers.all}function drawLayers(gpu,[width,height],paper,count,draw){let{gl}=gpu;if(count===0)return;let fineness=chooseFineness(Math.max(width,height)),size=[fineness*width,fineness*height],all=findLayers(gl,size,count);gl.viewport(0,0,...size),gl.enable(gl.DEPTH_TEST);for(let solid=0;solid<count;solid++)gl.bindFramebuffer(gl.FRAMEBUFFER,all[solid].frame),gl.clearColor(0,0,0,0),gl.clear(gl.COLOR_BUFFER_BIT|gl.DEPTH_BUFFER_BIT),draw(solid);program??=finishProgram(gl,beginProgram(gl,COVER,layers_default)),beginPicture(gpu,width,height),gl.useProgram(program.program);let textures={};for(let i=0;i<MOST;i++){let{colour,depth}=all[Math.min(i,all.length-1)];textures[`colour${i}`]=colour,textures[`depth${i}`]=depth}bindTextures(gl,program,textures),gl.uniform3f(program.uniforms.paper,...paper),gl.uniform1i(program.uniforms.count,count),gl.uniform1i(program.uniforms.fineness,fineness),gl.disable(gl.DEPTH_TEST),gl.drawArrays(gl.TRIANGLES,0,3)}var CRC_TABLE=makeCrcTable();function makeCrcTable(){let table=new Uint32Array(256);for(let n=0;n<256;n++){let c=n;for(let bit=0;bit<8;bit++)c=c&1?3988292384^c>>>1:c>>>1;table[n]=c>>>0}return table}function computeCrc(bytes){let c=4294967295;for(let byte of bytes)c=CRC_TABLE[(c^byte)&255]^c>>>8;return(c^4294967295)>>>0}function makeTextChunk(keyword,text){let content=`${keyword}\0${text}`,chunk=new Uint8Array(content.length+12),view=new DataView(chunk.buffer);view.setUint32(0,content.length);let named=`tEXt${content}`;for(let i=0;i<named.length;i++){let code=named.charCodeAt(i);chunk[4+i]=code<256?code:63}return view.setUint32(chunk.length-4,computeCrc(chunk.subarray(4,chunk.length-4))),chunk}var HEAD=33;function annotatePng(png,texts){let chunks=Object.entries(texts).map(([keyword,text])=>makeTextChunk(keyword,text));return new Blob([png.slice(0,HEAD),...chunks,png.slice(HEAD)],{type:"image/png"})}async function savePicture(canvas,name,texts){let copy=document.createElement("canvas");copy.width=canvas.width,copy.height=canvas.height;let context=copy.getContext("2d");context.fillStyle=getComputedStyle(document.documentElement).getPropertyValue("--paper"),context.fillRect(0,0,copy.width,copy.height),context.drawImage(canvas,0,0);let blob=await new Promise(done=>copy.toBlob(done,"image/png"));if(!blob)return;let annotated=annotatePng(new Uint8Array(await blob.arrayBuffer()),texts),link=document.createElement("a");link.href=URL.createObjectURL(annotated),link.download=`merlkit-${name}.png`,link.click(),setTimeout(()=>URL.revokeObjectURL(link.href),1e4)}var DEFAULTS={materials:[],theta:30,phi:0,shape:"",normals:"flat",light:"directional",lightTheta:45,lightPhi:-35,exposure:0,value:"f-cos",scale:"linear",polarZoom:1,polarX:0,polarY:0,plotZoom:1,plotX:0,plotY:0,elevation:25,azimuth:20,phiD:90,phiH:0,slice:"colour",sliceExposure:0,sampler:"half-vector:64KB",rival:"cosine",batches:1,nMax:2,over:"draws",map:"studio",strategy:"light",keep:1024,candidates:8},DOMAINS={theta:[0,89],phi:[0,358],lightTheta:[0,180],lightPhi:[-180,180],exposure:[-10,10],polarZoom:[1,64],polarX:[0,1],polarY:[0,1],plotZoom:[1,64],plotX:[0,1],plotY:[0,1],elevation:[0,90],azimuth:[-180,180],phiD:[0,179],phiH:[0,358],sliceExposure:[-10,10],batches:[1,64],nMax:[1.1,16],keep:[16,4096],candidates:[1,64]},WORDS={normals:["flat","smooth"],value:["f-cos","f"],scale:["linear","log"],slice:["colour","difference"],over:["draws","nothing"],strategy:["light","brdf","ris"]},MOST_MATERIALS=3;function writeFragment(state){let parts=state.materials.map(name=>`material=${encodeURIComponent(name)}`);for(let key of Object.keys(DEFAULTS))key!=="materials"&&state[key]!==DEFAULTS[key]&&parts.push(`${key}=${encodeURIComponent(state[key])}`);return parts.join("&")}function readFragment(fragment){let given=new URLSearchParams(fragment.replace(/^#/,"")),state={...DEFAULTS,materials:given.getAll("material").slice(0,MOST_MATERIALS)};for(let key of Object.keys(DEFAULTS)){let text=given.get(key);if(text===null||key==="materials")continue;let value=readValue(key,text);value!==null&&Object.assign(state,{[key]:value})}return state}function readValue(key,text){let domain=DOMAINS[key];if(domain){let number=Number(text);return text.trim()&&Number.isFinite(number)?Math.min(Math.max(number,domain[0]),domain[1]):null}let words=WORDS[key];return words&&!words.includes(text)?null:text}function findNearest(list,value){return list.reduce((best,x)=>Math.abs(x-value)<Math.abs(best-value)?x:best,list[0]??value)}var MOST_PIXELS_PER_PIXEL=2;function makeFrame(panel,parent,view){let section=addElement(parent,"section",{id:panel.id}),head=addElement(section,"header");addElement(head,"h2").textContent=panel.title;let controls=addElement(section,"div",{class:"controls"}),canvas=addElement(section,"canvas",{role:"img","aria-label":panel.title});addElement(section,"p",{class:"caption","aria-live":"polite"}),addButton(head,"PNG",`Save ${panel.title} as a PNG picture`,()=>{let{state,catalogue}=view();savePicture(canvas,panel.id,{Software:`merlkit ${catalogue.version} explore`,Title:`${panel.title}: ${state.materials.join(", ")}`,Source:panel.command(view())??"",Comment:`#${writeFragment(state)}`})}),addButton(head,"Command",`Copy the command that makes ${panel.title}`,button=>{copyText(panel.command(view()),button)});let context=canvas.getContext("2d"),frame={section,canvas,context,controls,isSeen:!1,aspect:panel.aspect,syncs:[],size:()=>{let width=Math.max(canvas.clientWidth,64);return[width,Math.round(width*frame.aspect)]},begin:()=>{let[width,height]=frame.size(),scale=Math.min(devicePixelRatio||1,MOST_PIXELS_PER_PIXEL),[across,down]=[Math.round(width*scale),Math.round(height*scale)];return(canvas.width!==across||canvas.height!==down)&&(canvas.width=across,canvas.height=down),canvas.style.aspectRatio=`${width} / ${height}`,context.setTransform(across/width,0,0,down/height,0,0),context.clearRect(0,0,width,height),[width,height]}};return canvas.style.aspectRatio=`1 / ${panel.aspect}`,panel.prepare?.(frame,view),frame}function setCaption(frame,text,isError){let caption=frame.section.querySelector(".caption");caption.textContent!==text&&(caption.textContent=text),caption.classList.toggle("error",isError)}async function copyText(text,button){let said=button.textContent;try{text!==null&&await navigator.clipboard.writeText(text),button.textContent=text===null?"No command makes this":"Copied"}catch{button.textContent=text}setTimeout(()=>button.textContent=said,4e3)}function addElement(parent,name,attributes={}){let element=document.createElement(name);for(let[key,value]of Object.entries(attributes))element.setAttribute(key,value);return parent.appendChild(element)}function addButton(parent,text,title,act){let button=addElement(parent,"button",{type:"button",title});return button.textContent=text,button.addEventListener("click",()=>act(button)),button}function addSlider(parent,name,range,value,act){let label=addElement(parent,"label",{class:"slider"});addElement(label,"span").textContent=name;let{min,max,step}=range.isLog?{min:Math.log(range.min),max:Math.log(range.max),step:.01}:range,input=addElement(label,"input",{type:"range",min:`${min}`,max:`${max}`,step:`${step}`}),output=addElement(label,"output");function show(shown){input.value=String(range.isLog?Math.log(shown):shown),output.textContent=`${Number(shown.toPrecision(4))}${range.unit}`}return input.addEventListener("input",()=>{let chosen=range.isLog?Math.exp(Number(input.value)):Number(input.value);show(chosen),act(chosen)}),show(value),show}function addSelect(parent,name,options,value,act){let label=addElement(parent,"label");addElement(label,"span").textContent=name;let select=addElement(label,"select");for(let option of options)addElement(select,"option",{value:option}).textContent=option;select.addEventListener("change",()=>act(select.value));function show(shown){[...select.options].some(option=>option.value===shown)||(addElement(select,"option",{value:shown}).textContent=shown),select.value=shown}return show(value),show}function bindSlider(frame,view,name,key,range){let show=addSlider(frame.controls,name,range,view().state[key],value=>view().change({[key]:value}));frame.syncs.push(state=>show(state[key]))}function bindSelect(frame,view,name,key,options){let show=addSelect(frame.controls,name,options,view().state[key],value=>view().change({[key]:value}));frame.syncs.push(state=>show(state[key]))}function onDrag(canvas,hint,move){canvas.classList.add("draggable"),canvas.tabIndex=0,canvas.title=hint,canvas.addEventListener("pointerdown",event=>canvas.setPointerCapture(event.pointerId)),canvas.addEventListener("pointermove",event=>{canvas.hasPointerCapture(event.pointerId)&&move(event.movementX,event.movementY,event)});let keys={ArrowLeft:[-8,0],ArrowRight:[8,0],ArrowUp:[0,-8],ArrowDown:[0,8]};canvas.addEventListener("keydown",event=>{let step=keys[event.key];step&&(event.preventDefault(),move(step[0],step[1],event))})}var lobe_vertex_default=`#version 300 es
// A point of a lobe, seen from infinitely far away.
layout(location = 0) in vec3 position;
uniform mat3 view;
uniform vec2 scale;
uniform float base;
out vec3 seen;

void main()
{
    seen = view * position;
    gl_Position = vec4(scale * (seen.xy + vec2(0.0, base)), -0.25 * seen.z, 1.0);
}
`;var lobe_fragment_default=`#version 300 es
// The surface of a lobe, lit from the upper left in front.
precision highp float;
in vec3 seen;
uniform vec3 colour;
out vec4 painted;

void main()
{
    vec3 normal = normalize(cross(dFdx(seen), dFdy(seen)));
    float light = 0.45 + 0.55 * abs(dot(normal, normalize(vec3(-0.4, 0.6, 0.7))));
    painted = vec4(colour * light, 1.0);
}
`;var ROWS=90,COLUMNS=180,DECADES=4,PIXELS_PER_DEGREE=2;function snapTheta({state,catalogue}){return catalogue.stored?findNearest(catalogue.stored.thetas,state.theta):state.theta}function askedPhi(entry,state){return entry.isotropic?0:2*Math.round(state.phi/2)}function askLobe(source,id,theta,phi){let key=makeKey("lobe",[["material",id],["theta",theta],["phi",phi],["rows",ROWS],["columns",COLUMNS]]);return askBinary(source,key)}async function loadLobe(source,entry,theta,state){let{arrays}=await askLobe(source,entry.id,theta,askedPhi(entry,state));return{entry,f:arrays.f,turn:entry.isotropic?state.phi:0,theta}}function readLobe(lobe,row,column,value){let i=3*(row*COLUMNS+(column%COLUMNS+COLUMNS)%COLUMNS),mean=(lobe.f[i]+lobe.f[i+1]+lobe.f[i+2])/3;return value==="f"?mean:mean*Math.cos((row+.5)*Math.PI/180)}function findGreatest(lobes,value){let greatest=0;for(let lobe of lobes)for(let row=0;row<ROWS;row++)for(let column=0;column<COLUMNS;column++)greatest=Math.max(greatest,readLobe(lobe,row,column,value));return greatest}function scaleRadius(value,greatest,scale){return value>0&&greatest>0?scale==="linear"?value/greatest:Math.max(0,1+Math.log10(value/greatest)/DECADES):0}function makeDirection(theta,phi){let[t,p]=[theta*Math.PI/180,phi*Math.PI/180];return[Math.sin(t)*Math.cos(p),Math.sin(t)*Math.sin(p),Math.cos(t)]}function makeMesh(lobe,greatest,state){let positions=new Float32Array(3*(1+ROWS*COLUMNS)),indices=[],pole=0;for(let column=0;column<COLUMNS;column++)pole+=readLobe(lobe,0,column,state.value)/COLUMNS;positions[2]=scaleRadius(pole,greatest,state.scale);for(let row=0;row<ROWS;row++)for(let column=0;column<COLUMNS;column++){let radius=scaleRadius(readLobe(lobe,row,column,state.value),greatest,state.scale),direction=makeDirection(row+.5,2*column+lobe.turn),here=1+row*COLUMNS+column;for(let axis=0;axis<3;axis++)positions[3*here+axis]=radius*direction[axis];let next=1+row*COLUMNS+(column+1)%COLUMNS;row===0?indices.push(0,here,next):indices.push(here-COLUMNS,here,next,here-COLUMNS,next,next-COLUMNS)}return{positions,indices:new Uint16Array(indices)}}function makeAxes(elevation,azimuth){let[e,p]=[elevation*Math.PI/180,(90-azimuth)*Math.PI/180],back=[Math.cos(p)*Math.cos(e),Math.sin(p)*Math.cos(e),Math.sin(e)],right=[-Math.sin(p),Math.cos(p),0],up=[-Math.cos(p)*Math.sin(e),-Math.sin(p)*Math.sin(e),Math.cos(e)];return[right,up,back]}function dot(a,b){return a[0]*b[0]+a[1]*b[1]+a[2]*b[2]}var begun=null,program2=null,buffers=null;function drawMesh({gl},mesh){buffers||(buffers={vertices:gl.createBuffer(),indices:gl.createBuffer(),array:gl.createVertexArray()},gl.bindVertexArray(buffers.array),gl.bindBuffer(gl.ARRAY_BUFFER,buffers.vertices),gl.enableVertexAttribArray(0),gl.vertexAttribPointer(0,3,gl.FLOAT,!1,0,0),gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER,buffers.indices)),gl.bindVertexArray(buffers.array),gl.bindBuffer(gl.ARRAY_BUFFER,buffers.vertices),gl.bufferData(gl.ARRAY_BUFFER,mesh.positions,gl.DYNAMIC_DRAW),gl.bufferData(gl.ELEMENT_ARRAY_BUFFER,mesh.indices,gl.DYNAMIC_DRAW),gl.drawElements(gl.TRIANGLES,mesh.indices.length,gl.UNSIGNED_SHORT,0),gl.bindVertexArray(null)}var HALF_WIDTH=1.25;function prepareLobes(gpu){begun??=beginProgram(gpu.gl,lobe_vertex_default,lobe_fragment_default)}function drawSolids(gpu,frame,lobes,greatest,state){let{gl}=gpu,{canvas,context}=frame;prepareLobes(gpu),program2??=finishProgram(gl,begun);let theme=readTheme(),size=[canvas.width,canvas.height];gl.useProgram(program2.program);let[right,up,back]=makeAxes(state.elevation,state.azimuth);gl.uniformMatrix3fv(program2.uniforms.view,!0,[...right,...up,...back]),gl.uniform2f(program2.uniforms.scale,1/HALF_WIDTH,canvas.width/canvas.height/HALF_WIDTH),gl.uniform1f(program2.uniforms.base,shiftUp(state.elevation));function drawSolid(i){gl.uniform3f(program2.uniforms.colour,...readHex(theme.series[i])),drawMesh(gpu,makeMesh(lobes[i],greatest,state))}lobes.length===1?(beginPicture(gpu,...size),gl.clearColor(...readHex(theme.paper),1),gl.clear(gl.COLOR_BUFFER_BIT|gl.DEPTH_BUFFER_BIT),gl.enable(gl.DEPTH_TEST),drawSolid(0)):drawLayers(gpu,size,readHex(theme.paper),lobes.length,drawSolid),context.setTransform(1,0,0,1,0,0),copyPicture(gpu,size,context,[0,0,...size])}function shiftUp(elevation){return .5*(Math.sin(elevation*Math.PI/180)-1)}function drawGuides(frame,view,theta){let{context}=frame,[width,height]=frame.size(),{state}=view,theme=readTheme(),[right,up]=makeAxes(state.elevation,state.azimuth),unit=width/2/HALF_WIDTH,scale=frame.canvas.width/width;context.setTransform(scale,0,0,scale,0,0);function project(p){return[width/2+unit*dot(p,right),height/2-unit*(dot(p,up)+shiftUp(state.elevation))]}context.strokeStyle=theme.faint,context.lineWidth=1,context.beginPath();for(let phi=0;phi<=360;phi+=4)context.lineTo(...project(makeDirection(90,phi)));context.stroke(),context.fillStyle=theme.ink,context.font="13px system-ui, sans-serif",context.textAlign="center";for(let[name,phi,dashes]of[["wo",state.phi,[]],["mirror",state.phi+180,[4,4]]]){let end=project(makeDirection(theta,phi));context.strokeStyle=theme.ink,context.setLineDash(dashes),context.beginPath(),context.moveTo(...project([0,0,0])),context.lineTo(...end),context.stroke(),context.fillText(name,end[0],end[1]-6)}context.setLineDash([]);let names=view.materials.map((entry,i)=>({name:entry.name,colour:theme.series[i],points:[]}));drawLegend(context,names,{left:0,top:0,width,height},theme)}var lobePanel={id:"lobe",title:"Lobe",aspect:.85,depends:["materials","theta","phi","value","scale","elevation","azimuth"],prepare(frame,view){let drag={turns:"wo"};addSelect(frame.controls,"drag moves",["wo","the viewpoint"],drag.turns,turns=>drag.turns=turns),onDrag(frame.canvas,"Drag, or use the arrow keys, to move wo; with Shift, the viewpoint",(dx,dy,event)=>{let{state,change}=view();if(drag.turns==="wo"&&!event.shiftKey){let side=Math.cos((state.azimuth-state.phi)*Math.PI/180)<0?-1:1;change({theta:Math.round(Math.min(Math.max(state.theta-side*dx/PIXELS_PER_DEGREE,0),89)),phi:(state.phi+2*Math.round(dy/2/PIXELS_PER_DEGREE)+360)%360})}else change({azimuth:(Math.round(state.azimuth-dx/PIXELS_PER_DEGREE)+540)%360-180,elevation:Math.min(Math.max(Math.round(state.elevation+dy/PIXELS_PER_DEGREE),0),90)})})},async draw(frame,view){let{state,materials,source,gpu}=view,theta=snapTheta(view),lobes=await Promise.all(materials.map(entry=>loadLobe(source,entry,theta,state)));frame.begin();let greatest=findGreatest(lobes,state.value);gpu&&drawSolids(gpu,frame,lobes,greatest,state),drawGuides(frame,view,theta);let radius=state.scale==="linear"?"the radius is linear":`the radius covers ${DECADES} decades`;return`${state.value==="f"?"f_r":"f_r·cosθi"}, mean of red, green and blue, for wo at ${theta}°, ${state.phi}°; ${radius}, greatest ${greatest.toPrecision(3)} sr⁻¹.`},command({state,materials}){let names=nameMaterials(materials),together=materials.length>1?" --together":"",{theta,value,scale,elevation,azimuth}=state;return`merlkit plot ${names} --kind lobe-3d --theta ${theta} --value ${value} --scale ${scale} --elevation ${elevation} --azimuth=${azimuth}${together}`}};function shorten(value){return Number(value.toFixed(5))}function place(zoom,x,y){let bounded=shorten(Math.min(Math.max(zoom,1),64)),most=1-1/bounded,[across,down]=[x,y].map(from=>shorten(Math.min(Math.max(from,0),most)));return{zoom:bounded,x:across,y:down}}function zoomAbout(part,factor,[px,py]){let zoom=Math.min(Math.max(part.zoom*factor,1),64),shrunk=1/part.zoom-1/zoom;return place(zoom,part.x+px*shrunk,part.y+py*shrunk)}function movePart({zoom,x,y},dx,dy){return place(zoom,x-dx/zoom,y-dy/zoom)}function onZoom(canvas,box,read,write){let fingers=new Map;canvas.tabIndex=0,canvas.title="Wheel, two fingers, + and − zoom; dragging and arrow keys move what is zoomed; a double click or 0 shows all";function locate(x,y){let[left,top,width,height]=box(),edge=canvas.getBoundingClientRect();return[(x-edge.left-left)/width,(y-edge.top-top)/height]}function show(part){canvas.style.touchAction=part.zoom>1?"none":"pan-y",write(part)}canvas.style.touchAction=read().zoom>1?"none":"pan-y",canvas.addEventListener("wheel",event=>{let part=read();if(part.zoom===1&&event.deltaY>=0)return;event.preventDefault();let pixels=event.deltaMode===0?event.deltaY:event.deltaY*16;show(zoomAbout(part,2**(-pixels/240),locate(event.clientX,event.clientY)))},{passive:!1}),canvas.addEventListener("dblclick",()=>show(place(1,0,0))),canvas.addEventListener("keydown",event=>{let factor={"+":1.25,"=":1.25,"-":.8,"−":.8}[event.key],steps={ArrowLeft:[.1,0],ArrowRight:[-.1,0],ArrowUp:[0,.1],ArrowDown:[0,-.1]};if(!(event.ctrlKey||event.metaKey||event.altKey)){if(factor)show(zoomAbout(read(),factor,[.5,.5]));else if(event.key==="0")show(place(1,0,0));else if(steps[event.key]&&read().zoom>1)show(movePart(read(),...steps[event.key]));else return;event.preventDefault()}}),canvas.addEventListener("pointerdown",event=>{fingers.set(event.pointerId,[event.clientX,event.clientY]),canvas.setPointerCapture(event.pointerId)});for(let name of["pointerup","pointercancel"])canvas.addEventListener(name,event=>fingers.delete(event.pointerId));canvas.addEventListener("pointermove",event=>{if(!fingers.has(event.pointerId))return;let before=[...fingers.values()];fingers.set(event.pointerId,[event.clientX,event.clientY]);let after=[...fingers.values()],[from,to]=[findMiddle(before),findMiddle(after)],[,,width,height]=box(),moved=movePart(read(),(to[0]-from[0])/width,(to[1]-from[1])/height),spread=[before,after].map(measureSpread),factor=spread[0]>0&&spread[1]>0?spread[1]/spread[0]:1;(factor!==1||moved.zoom>1)&&show(zoomAbout(moved,factor,locate(...to)))})}function findMiddle(points){let sum2=points.reduce(([x,y],point)=>[x+point[0],y+point[1]],[0,0]);return[sum2[0]/points.length,sum2[1]/points.length]}function measureSpread([first,second]){return second?Math.hypot(second[0]-first[0],second[1]-first[1]):0}function cutLobe(lobe,state){let column=askedPhi(lobe.entry,state)/2,points=[];for(let row=ROWS-1;row>=0;row--)points.push([-(row+.5),readLobe(lobe,row,column,state.value)]);for(let row=0;row<ROWS;row++)points.push([row+.5,readLobe(lobe,row,column+COLUMNS/2,state.value)]);return points}async function loadCurves(view,theta,theme){let{state,materials,source}=view,lobes=await Promise.all(materials.map(entry=>loadLobe(source,entry,theta,state))),curves=lobes.map((lobe,i)=>({name:lobe.entry.name,colour:theme.series[i],dashes:DASHES[i],points:cutLobe(lobe,state)})),inPlane=curves.flatMap(curve=>curve.points.map(point=>point[1]));return{curves,greatest:Math.max(...inPlane,0)||findGreatest(lobes,state.value)}}function nameValue(state){return state.value==="f"?"f_r, 1/sr":"f_r·cosθi, 1/sr"}function addChoices(frame,view){bindSelect(frame,view,"value","value",["f-cos","f"]),bindSelect(frame,view,"scale","scale",["linear","log"])}function addZoom(frame,view,name,box){let[zoom,x,y]=[`${name}Zoom`,`${name}X`,`${name}Y`];function boxNow(){let{left,top,width,height}=box();return[left,top,width,height]}onZoom(frame.canvas,boxNow,()=>readPart(view().state,name),part=>view().change({[zoom]:part.zoom,[x]:part.x,[y]:part.y}))}function readPart(state,name){let part=name==="polar"?[state.polarZoom,state.polarX,state.polarY]:[state.plotZoom,state.plotX,state.plotY],most=1-1/part[0];return{zoom:part[0],x:Math.min(part[1],most),y:Math.min(part[2],most)}}function describeZoom({zoom}){return zoom>1?` Zoomed ${Number(zoom.toPrecision(2))} times; a double click shows all.`:""}function drawPolarGrid(context,[cx,cy],radius,theme,zoom,[width,height],write){context.strokeStyle=theme.faint,context.fillStyle=theme.ink,context.lineWidth=.5,context.font="12px system-ui, sans-serif",context.textAlign="center";let rings=4*2**Math.floor(Math.log2(zoom));for(let ring=1;ring<=rings;ring++){let r=radius*ring/rings;context.beginPath(),context.arc(cx,cy,r,Math.PI,2*Math.PI),context.stroke();let up=Math.sqrt(r*r-(width/2-cx)**2);zoom>1&&cy-up>0&&cy-up<height&&context.fillText(write(ring/rings),width/2,cy-up-3)}for(let angle=-90;angle<=90;angle+=30){let a=angle*Math.PI/180,end=[cx+radius*Math.sin(a),cy-radius*Math.cos(a)];drawLine(context,[cx,cy],end);let[x,y]=[cx+(radius+14)*Math.sin(a),cy-(radius+8)*Math.cos(a)];context.fillText(`${Math.abs(angle)}°`,x,y)}}var polarPanel={id:"polar",title:"Plane of incidence, polar",aspect:.66,depends:["materials","theta","phi","value","scale","polarZoom","polarX","polarY"],prepare(frame,view){addChoices(frame,view),addZoom(frame,view,"polar",()=>{let[width,height]=frame.size();return{left:0,top:0,width,height}})},async draw(frame,view){let theme=readTheme(),theta=snapTheta(view),{curves,greatest}=await loadCurves(view,theta,theme),[width,height]=frame.begin(),{context}=frame,part=readPart(view.state,"polar"),radius=part.zoom*Math.min(width/2-34,height-60),centre=[part.zoom*(width/2-part.x*width),part.zoom*(height-22-part.y*height)];function writeRing(fraction){let value=view.state.scale==="linear"?fraction*greatest:greatest*10**(DECADES*(fraction-1));return writeTick(Number(value.toPrecision(3)))}drawPolarGrid(context,centre,radius,theme,part.zoom,[width,height],writeRing);function place2(angle,value){let a=angle*Math.PI/180,r=radius*scaleRadius(value,greatest,view.state.scale);return[centre[0]+r*Math.sin(a),centre[1]-r*Math.cos(a)]}let box={left:0,top:0,width,height};for(let curve of curves)drawCurve(context,curve,place2,box);context.strokeStyle=theme.ink,context.lineWidth=1.5;let o=-theta*Math.PI/180;drawLine(context,centre,[centre[0]+radius*Math.sin(o),centre[1]-radius*Math.cos(o)]),context.fillStyle=theme.ink,context.fillText("wo",centre[0]+.8*radius*Math.sin(o)-14,centre[1]-.8*radius*Math.cos(o)),drawLegend(context,curves,box,theme);let rim=view.state.scale==="linear"?"":`, the centre ${DECADES} decades below`;return`${nameValue(view.state)} by the angle of wi; the rim is ${writeTick(Number(greatest.toPrecision(3)))} sr⁻¹${rim}. wo is on the left at ${theta}°.${describeZoom(part)}`},command({state,materials}){let scale=state.scale==="linear"?"linear":"root";return`merlkit plot ${nameMaterials(materials)} --kind lobe-polar --theta ${state.theta} --value ${state.value} --scale ${scale}`}};function findPlotBox([width,height]){return{left:52,top:26,width:width-66,height:height-68}}var cartesianPanel={id:"cartesian",title:"Plane of incidence, Cartesian",aspect:.66,depends:["materials","theta","phi","value","scale","plotZoom","plotX","plotY"],prepare(frame,view){addChoices(frame,view),addZoom(frame,view,"plot",()=>findPlotBox(frame.size()))},async draw(frame,view){let theme=readTheme(),theta=snapTheta(view),{curves,greatest}=await loadCurves(view,theta,theme),[width,height]=frame.begin(),box=findPlotBox([width,height]),part=readPart(view.state,"plot"),isLog=view.state.scale==="log",wholeX={label:"angle of wi, degrees (wo is on the left)",min:-90,max:90},top=greatest>0?greatest*(isLog?1.5:1.05):1,wholeY={label:nameValue(view.state),min:isLog?top/1e5:0,max:top,isLog},x=cutAxis(wholeX,part.x,part.x+1/part.zoom),y=cutAxis(wholeY,1-part.y-1/part.zoom,1-part.y),place2=drawAxes(frame.context,box,x,y,theme);frame.context.strokeStyle=theme.ink,frame.context.setLineDash([4,4]);for(let angle of[-theta,theta])angle>=x.min&&angle<=x.max&&drawLine(frame.context,place2(angle,y.min),place2(angle,y.max));for(let curve of curves)drawCurve(frame.context,curve,place2,box);return drawLegend(frame.context,curves,box,theme),`Dashed: wo at −${theta}° and its mirror direction at ${theta}°.${describeZoom(part)}`},command({state,materials}){let{theta,value,scale}=state;return`merlkit plot ${nameMaterials(materials)} --kind lobe --theta ${theta} --value ${value} --scale ${scale}`}};var BATCH=1024,MOST_BATCHES=64;function keyDraws(view,entry,sampler,batch){let{state,catalogue}=view;return makeKey("draws",[["material",entry.id],["sampler",sampler],["theta",snapTheta(view)],["phi",askedPhi(entry,state)],["count",catalogue.stored?.count??BATCH],["seed",(catalogue.stored?.seed??1)+batch]])}async function loadDraws(source,key){let{arrays}=await askBinary(source,key);return{wi:arrays.wi,pdf:arrays.pdf,weight:arrays.weight}}function countDraws({pdf}){return pdf.reduce((count,density)=>count+(density>0?1:0),0)}function drawDots(frame,{centre,radius,turn},{wi,pdf},colour){let{context,canvas}=frame,scale=canvas.width/frame.size()[0],side=Math.max(1,Math.round(scale)),[cos,sin]=[Math.cos(turn*Math.PI/180),Math.sin(turn*Math.PI/180)];context.save(),context.setTransform(1,0,0,1,0,0),context.fillStyle=colour;for(let i=0;i<pdf.length;i++){if(!(pdf[i]>0))continue;let x=cos*wi[3*i]-sin*wi[3*i+1],y=sin*wi[3*i]+cos*wi[3*i+1];context.fillRect(Math.floor(scale*(centre[0]+radius*x)),Math.floor(scale*(centre[1]-radius*y)),side,side)}context.restore()}function drawRim(frame,{centre,radius},label){let{context}=frame,theme=readTheme();context.strokeStyle=theme.faint,context.lineWidth=1;for(let angle of[30,60,90])context.beginPath(),context.arc(...centre,radius*Math.sin(angle*Math.PI/180),0,2*Math.PI),context.stroke();context.fillStyle=theme.ink,context.font="12px system-ui, sans-serif",context.textAlign="center",context.fillText(label,centre[0],centre[1]-radius-6)}function addBatch(estimate,{pdf,weight},truth){for(let i=0;i<pdf.length;i++){let mean=(weight[3*i]+weight[3*i+1]+weight[3*i+2])/3;estimate.sum+=mean,estimate.squares+=mean*mean,pdf[i]>0||(estimate.failed+=1)}estimate.count+=pdf.length,estimate.errors.push([estimate.count,Math.abs(estimate.sum/estimate.count-truth)/truth])}function measureSpread2({count,sum:sum2,squares}){let mean=sum2/count;return Math.sqrt(Math.max(squares/count-mean*mean,0))/mean}var latest=0;function layOut(width,height){let radius=Math.min(width/4-10,.3*height),down=radius+26,discs=[.25,.75].map(x=>({centre:[width*x,down],radius,turn:0})),top=down+radius+34;return{discs:[discs[0],discs[1]],chart:{left:56,top,width:width-72,height:height-top-44}}}function drawErrors(frame,chart,estimates,floor){let theme=readTheme(),curves=estimates.map(({sampler,errors},i)=>({name:sampler,colour:theme.series[i],dashes:DASHES[i],points:errors.map(([count,error])=>[count,Math.max(error,1e-7)])})),all=curves.flatMap(curve=>curve.points),[low,high]=[Math.min(...all.map(p=>p[1])),Math.max(...all.map(p=>p[1]))],most=Math.max(...all.map(p=>p[0])),x={label:"draws",min:BATCH/2,max:Math.max(2*most,8*BATCH),isLog:!0},min=10**Math.floor(Math.log10(low)),below=Math.max(1-measureLegend(curves.length+1)/chart.height,.5),max=Math.max(min*(high/min)**(1/below),10*min),y={label:"relative error of the albedo",min,max,isLog:!0};frame.context.fillStyle=theme.paper,frame.context.fillRect(0,chart.top-26,frame.size()[0],frame.size()[1]-chart.top+26);let place2=drawAxes(frame.context,chart,x,y,theme);for(let curve of curves){drawCurve(frame.context,curve,place2,chart),frame.context.fillStyle=curve.colour;for(let[count,error]of curve.points){let[across,down]=place2(count,error);frame.context.fillRect(across-2,down-2,4,4)}}if(floor>y.min&&floor<y.max){let line={name:"error of the quadrature",colour:theme.soft,dashes:[2,4],points:[[x.min,floor],[x.max,floor]]};drawCurve(frame.context,line,place2,chart),curves.push(line)}drawLegend(frame.context,curves,chart,theme)}function describeEstimates(estimates,truth,theta){let parts=estimates.map(estimate=>{let error=estimate.errors[estimate.errors.length-1][1],failed=estimate.failed?`, ${estimate.failed} failed`:"";return`${estimate.sampler}: error ${(100*error).toPrecision(2)} % after ${estimate.count} draws, relative standard deviation of a weight ${measureSpread2(estimate).toPrecision(2)}${failed}`}),mean=(truth.rgb[0]+truth.rgb[1]+truth.rgb[2])/3;return`Albedo at ${theta}° by quadrature ${mean.toPrecision(4)} (± ${truth.error.toPrecision(1)}). ${parts.join(". ")}. Draws of a batch are spread together.`}function snapSampler({catalogue},sampler,i){let held2=catalogue.stored?.samplers;return!held2||held2.includes(sampler)?sampler:held2[Math.min(i,held2.length-1)]}async function accumulate(frame,view){latest+=1;let number=latest,{state,materials,source}=view,[entry]=materials,theta=snapTheta(view),truth=await askJson(source,makeKey("albedo",[["material",entry.id],["theta",theta],["phi",askedPhi(entry,state)]])),mean=(truth.rgb[0]+truth.rgb[1]+truth.rgb[2])/3,samplers=[state.sampler,state.rival].map((sampler,i)=>snapSampler(view,sampler,i)),estimates=samplers.map(sampler=>({sampler,count:0,sum:0,squares:0,failed:0,errors:[]})),caption="";for(let batch=0;batch<state.batches;batch++){let keys=samplers.map(sampler=>keyDraws(view,entry,sampler,batch));if(batch>0&&!keys.every(key=>source.holds(key)))break;let drawn=await Promise.all(keys.map(key=>loadDraws(source,key)));if(number!==latest)return caption;let theme=readTheme(),{discs,chart}=layOut(...batch===0?frame.begin():frame.size());drawn.forEach((draws,i)=>{discs[i].turn=entry.isotropic?state.phi:0,batch===0&&drawRim(frame,discs[i],samplers[i]),drawDots(frame,discs[i],draws,theme.series[i]),addBatch(estimates[i],draws,mean)}),drawErrors(frame,chart,estimates,truth.error/mean),caption=describeEstimates(estimates,truth,theta)}return frame.canvas.dataset.count=String(estimates[0].count),caption}var drawsPanel={id:"draws",title:"Draws",aspect:1.15,depends:["materials","theta","phi","sampler","rival","batches"],prepare(frame,view){let texts=view().catalogue.stored?.samplers??view().catalogue.samplers.map(sampler=>sampler.text);bindSelect(frame,view,"sampler","sampler",texts),bindSelect(frame,view,"beside","rival",texts),!view().source.isStored&&addButton(frame.controls,"More draws",`Twice as many draws of each sampler, up to ${MOST_BATCHES*BATCH}`,()=>{view().change({batches:Math.min(2*view().state.batches,MOST_BATCHES)})})},draw:accumulate,command(view){let{state,materials}=view,sampler=quoteWord(state.sampler);return`merlkit sample ${nameMaterials(materials.slice(0,1))} --sampler ${sampler} --theta ${state.theta} --phi ${state.phi} --count ${state.batches*BATCH} --seed 1`}};function snapNMax({state,catalogue}){return catalogue.stored?findNearest(catalogue.stored.n_max,state.nMax):state.nMax}function drawLeaves(frame,{centre,radius,turn},{arrays}){let{context}=frame,{rectangles,probabilities}=arrays,densities=[];for(let leaf=0;leaf<probabilities.length;leaf++){let[x0,y0,x1,y1]=rectangles.subarray(4*leaf,4*leaf+4);densities.push(Math.log10(probabilities[leaf]/((x1-x0)*(y1-y0))))}let greatest=Math.max(...densities.filter(Number.isFinite)),leaves=0;return context.save(),context.translate(...centre),context.scale(radius,-radius),context.rotate(turn*Math.PI/180),context.beginPath(),context.arc(0,0,1,0,2*Math.PI),context.clip(),context.lineWidth=.6/radius,context.strokeStyle=readTheme().paper,densities.forEach((density,leaf)=>{if(!Number.isFinite(density))return;leaves+=1;let[x0,y0,x1,y1]=rectangles.subarray(4*leaf,4*leaf+4);context.fillStyle=`rgb(${viridis(1+(density-greatest)/4).join(",")})`,context.fillRect(x0,y0,x1-x0,y1-y0),context.strokeRect(x0,y0,x1-x0,y1-y0)}),context.restore(),leaves}function nameSampler(nMax){return nMax===2?"adaptive-disc":`adaptive-disc:n-max=${nMax}`}var discPanel={id:"disc",title:"Adaptive disc",aspect:1,depends:["materials","theta","phi","nMax","over"],prepare(frame,view){bindSlider(frame,view,"n_max","nMax",{min:1.1,max:16,step:.1,unit:""}),bindSelect(frame,view,"over it","over",["draws","nothing"])},async draw(frame,view){let{state,materials,source}=view,[entry]=materials,theta=snapTheta(view),nMax=snapNMax(view),answer=await askBinary(source,makeKey("disc",[["material",entry.id],["theta",theta],["n_max",nMax]])),key=keyDraws(view,entry,nameSampler(nMax),0),draws=state.over==="draws"&&source.holds(key)?await loadDraws(source,key):null,[width,height]=frame.begin(),disc={centre:[width/2,height/2],radius:Math.min(width,height)/2-10,turn:entry.isotropic?state.phi:0},leaves=drawLeaves(frame,disc,answer);draws&&drawDots(frame,disc,draws,readTheme().ink);let{bytes,trials}=answer.members,dots=draws?` ${countDraws(draws)} draws of ${nameSampler(nMax)}.`:"";return`${leaves} leaves of ${entry.name} about wo at ${theta}° for n_max ${nMax}, coloured by probability over area, 4 decades. ${(bytes/1e3).toFixed(0)} KB for all angles, ${trials.toFixed(2)} trials a draw.${dots}`},command({state,materials}){let{theta,nMax}=state;return`merlkit plot ${nameMaterials(materials.slice(0,1))} --kind disc --theta ${theta} --sampler ${nameSampler(nMax)} --samples 1024`}};async function drawMap(frame,radiance,[across,down],[width,height]){let pixels=new Uint8ClampedArray(4*across*down);for(let i=0;i<across*down;i++){for(let channel=0;channel<3;channel++)pixels[4*i+channel]=encodeSrgb(radiance[3*i+channel]);pixels[4*i+3]=255}let small=document.createElement("canvas");[small.width,small.height]=[across,down],small.getContext("2d").putImageData(new ImageData(pixels,across,down),0,0),frame.context.drawImage(small,0,0,width,height)}function drawPoints(frame,uv,pdf,[width,height]){let{context}=frame;context.fillStyle=readTheme().series[1],context.strokeStyle="#000000",context.lineWidth=.5;let count=0;for(let i=0;i<pdf.length;i++)pdf[i]>0&&(count+=1,context.beginPath(),context.arc(width*uv[2*i],height*uv[2*i+1],1.8,0,2*Math.PI),context.fill(),context.stroke());return count}var environmentPanel={id:"environment",title:"Environment",aspect:.5,depends:["materials","theta","phi","map","strategy","keep","candidates"],prepare(frame,view){bindSelect(frame,view,"map","map",view().catalogue.environments),bindSelect(frame,view,"directions by","strategy",["light","brdf","ris"]),bindSlider(frame,view,"kept","keep",{min:16,max:4096,step:16,unit:""}),bindSlider(frame,view,"candidates of ris","candidates",{min:1,max:64,step:1,unit:""})},async draw(frame,view){let{state,materials,source}=view,[entry]=materials,theta=snapTheta(view),map=await askBinary(source,makeKey("environment",[["name",state.map]])),key=makeKey("environment-draws",[["name",state.map],["material",entry.id],["strategy",state.strategy],["theta",theta],["phi",source.isStored?0:state.phi],["keep",state.keep],["candidates",state.candidates],["seed",1]]),draws=source.holds(key)?await askBinary(source,key):null,size=frame.begin();if(await drawMap(frame,map.arrays.radiance,map.members.size,size),!draws)return`${state.map}. This exported page holds no directions for these settings.`;let count=drawPoints(frame,draws.arrays.uv,draws.arrays.pdf,size),ways={light:"the map's light",brdf:`the half-vector table of ${entry.name}`,ris:`resampling one of ${state.candidates} draws of the half-vector table`};return`${count} directions by ${ways[state.strategy]}, for wo at ${theta}°, ${source.isStored?0:state.phi}° on a surface that faces the zenith. Latitude by longitude, the zenith on top.`},command({state,materials}){let candidates=state.strategy==="ris"?` --candidates ${state.candidates}`:"";return`merlkit render ${nameMaterials(materials.slice(0,1))} --light ${state.map} --strategy ${state.strategy}${candidates} -o environment`}};var resolved=new Map;function resolveMaterial(source,catalogue,text){let listed=catalogue.materials.find(entry2=>entry2.name===text);if(listed)return Promise.resolve(listed);let entry=resolved.get(text);return entry||(entry=askJson(source,makeKey("formula",[["text",text]])),resolved.set(text,entry),entry.then(({name})=>resolved.set(name,entry),()=>resolved.delete(text))),entry}function replaceParameter(text,name,value){let[model,list=""]=text.split(/:(.*)/s),settings=list.split(",").filter(setting=>setting&&!setting.startsWith(`${name}=`));return`${model}:${[...settings,`${name}=${value}`].join(",")}`}function showMaterials(area,view,say2){area.replaceChildren();let{state,materials,catalogue,source,change}=view(),names=catalogue.materials.map(entry=>entry.name);if(state.materials.forEach((text,i)=>{let row2=addElement(area,"div",{class:`material series-${i}`});addSelect(row2,["first","second","third"][i],names,text,name=>{change({materials:view().state.materials.map((old,k)=>k===i?name:old)})}),state.materials.length>1&&addButton(row2,"Remove",`Remove ${text}`,()=>change({materials:view().state.materials.filter((_,k)=>k!==i)}));let entry=materials.find(m=>m.name===text);source.isStored||addFit(row2,view,text,say2),entry&&!source.isStored&&addParameters(row2,view,entry,i);for(let note of entry?.notes??[])addElement(row2,"p",{class:"note"}).textContent=note}),state.materials.length>=MOST_MATERIALS)return;let row=addElement(area,"div",{class:"material"}),free=names.find(name=>!state.materials.includes(name));free&&addButton(row,"Add","Show another material as well",()=>change({materials:[...view().state.materials,free]})),source.isStored||addFormula(row,view)}function addFormula(row,view){let none="choose…",{formulas}=view().catalogue;addSelect(row,"formula",[none,...formulas.map(formula=>formula.name)],none,name=>{let formula=formulas.find(known=>known.name===name);formula&&view().change({materials:[...view().state.materials,formula.text].slice(-MOST_MATERIALS)})});let form=addElement(row,"form"),label=addElement(form,"label");addElement(label,"span").textContent="or its text";let input=addElement(label,"input",{type:"text",placeholder:"ward:sx=0.2,sy=0.2",size:"22",spellcheck:"false"});addElement(form,"button",{type:"submit"}).textContent="Show",form.addEventListener("submit",event=>{event.preventDefault();let text=input.value.trim();text&&view().change({materials:[...view().state.materials,text].slice(-MOST_MATERIALS)})})}function addParameters(row,view,entry,i){let text=entry.text??entry.name;function set(name,value){text=replaceParameter(text,name,value);let{state,change}=view();change({materials:state.materials.map((old,k)=>k===i?text:old)},!0)}for(let parameter of entry.parameters){let{name,kind,choices=[]}=parameter;if(kind==="choice"){addSelect(row,name,choices,String(parameter.value),value=>set(name,value));continue}let{min=0,max=1}=parameter,range={min,max,step:(max-min)/200,unit:"",isLog:min>0&&max>50*min};if(kind==="number"){addSlider(row,name,range,Number(parameter.value),value=>set(name,writeNumber(value)));continue}let colour=[...parameter.value];["red","green","blue"].forEach((channel,c)=>{addSlider(row,`${name} ${channel}`,range,colour[c],value=>{colour[c]=value,set(name,colour.map(writeNumber).join("/"))})})}}function writeNumber(value){return String(Number(value.toPrecision(5)))}function addFit(row,view,text,say2){let{catalogue}=view();if(!catalogue.models.length)return;let model=catalogue.models.includes("ggx")?"ggx":catalogue.models[0];addSelect(row,"fit",catalogue.models,model,chosen=>model=chosen),addButton(row,"Fit",`Fit a model to ${text} and show both`,button=>{button.disabled=!0,say2(`Fitting ${model} to ${text}…`),fitMaterial(view,text,model).then(say2,error=>say2(error.message)).finally(()=>button.disabled=!1)})}async function fitMaterial(view,text,model){let{source,catalogue,change}=view(),entry=await resolveMaterial(source,catalogue,text),fit=await askJson(source,makeKey("fit",[["material",entry.id],["model",model]]));change({materials:[text,fit.material],slice:"difference"});let numbers=Object.entries(fit).filter(([,value])=>typeof value=="number");return`Fitted ${model} to ${text}. ${numbers.map(([name,value])=>`${name} ${Number(value.toPrecision(3))}`).join(", ")}`}var MESH_NAMES=/\.(obj|ply|gltf|glb)$/i;async function loadFile(view,file){let{catalogue,source}=view();if(MESH_NAMES.test(file.name)){let mesh=await source.sendMesh(file.name,file);return catalogue.meshes=[...catalogue.meshes.filter(known=>known.name!==mesh.name),mesh],view().change({shape:mesh.name}),mesh.name}let entry=await source.send(file.name,file);catalogue.materials=[...catalogue.materials.filter(known=>known.name!==entry.name),entry];let others=view().state.materials.filter(name=>name!==entry.name);return view().change({materials:[...others,entry.name].slice(-MOST_MATERIALS)}),entry.name}function acceptFiles(view,say2){async function load(files){for(let file of files??[]){say2(`Loading ${file.name}…`);try{say2(`Loaded ${await loadFile(view,file)}.`)}catch(error){say2(`${file.name}: ${error.message}`)}}}document.addEventListener("dragover",event=>event.preventDefault()),document.addEventListener("drop",event=>{event.preventDefault(),load(event.dataTransfer?.files)});let input=document.getElementById("file");input.addEventListener("change",()=>{load(input.files)})}var THETA_BINS=90,CELLS_ACROSS=1620,WORDS_ACROSS=2048,INVALID=4160749568;async function loadTable(source,entry){let{members,arrays}=await askBinary(source,makeKey("table",[["material",entry.id]])),words=arrays.table,phiBins=words.length/THETA_BINS/THETA_BINS;if(phiBins!==180&&phiBins!==360)throw new Error(`the table of ${entry.name} has ${words.length} cells: page and server differ in version`);return{words,phiBins,unit:members.unit,error:members.error,resampled:members.resampled===!0}}function readCell(table,cell,out){let word=table.words[cell];if(word===INVALID)return!1;let unit=2**(word>>>27)*table.unit;return out[0]=(word&511)*unit,out[1]=(word>>>9&511)*unit,out[2]=(word>>>18&511)*unit,!0}var NODES=[64,64,20,24],BLOCKS_ACROSS=4;async function uploadTable(gpu,source,entry){let table=await loadTable(source,entry),cells=makeWordTexture(gpu.gl,table.words,CELLS_ACROSS),note=table.resampled?` ${entry.name} is resampled at the centres of MERL's bins.`:"";return{cells,grid:null,unit:table.unit,phiBins:table.phiBins,words:null,note}}function writePercent(fraction){return`${Number((100*fraction).toPrecision(2))} %`}async function uploadGrid({gl},source,entry){let{members,arrays}=await askBinary(source,makeKey("grid",[["material",entry.id]])),[phiH,thetaH,thetaD,phiD]=NODES,block=3*phiH*thetaH*thetaD;if(arrays.log2?.length!==block*phiD)throw new Error(`the grid of ${entry.name} has another size: page and server differ in version`);let grid=gl.createTexture();gl.bindTexture(gl.TEXTURE_3D,grid),gl.pixelStorei(gl.UNPACK_ALIGNMENT,1),gl.texStorage3D(gl.TEXTURE_3D,1,gl.RGB16F,phiH,BLOCKS_ACROSS*thetaH,phiD/BLOCKS_ACROSS*thetaD);for(let k=0;k<phiD;k++){let words=arrays.log2.subarray(k*block,(k+1)*block),corner=[0,k%BLOCKS_ACROSS*thetaH,Math.floor(k/BLOCKS_ACROSS)*thetaD];gl.texSubImage3D(gl.TEXTURE_3D,0,...corner,phiH,thetaH,thetaD,gl.RGB,gl.HALF_FLOAT,words)}for(let name of[gl.TEXTURE_MIN_FILTER,gl.TEXTURE_MAG_FILTER])gl.texParameteri(gl.TEXTURE_3D,name,gl.LINEAR);gl.texParameteri(gl.TEXTURE_3D,gl.TEXTURE_WRAP_S,gl.REPEAT);for(let name of[gl.TEXTURE_WRAP_T,gl.TEXTURE_WRAP_R])gl.texParameteri(gl.TEXTURE_3D,name,gl.CLAMP_TO_EDGE);let errors=`half of its values move by less than ${writePercent(members.median)}, 99 of 100 by less than ${writePercent(members.percentile99)}`,note=` ${entry.name} is anisotropic and resampled at ${thetaH} × ${phiH} × ${thetaD} × ${phiD} angles θh, φh, θd, φd: ${errors}.`;return{cells:null,grid,unit:1,phiBins:1,words:null,note}}function cutSampler(file){let head=new Uint32Array(file,0,32);if(head[0]!==1819436397||head[2]!==1)throw new Error("the run-time file has another version than this page");let[tables,rows,segments]=[head[5],head[6],head[7]],nodes=tables*rows*(segments+1),count=32+tables+2*(rows+1)+Math.ceil(tables*rows/2)+Math.ceil(tables*rows/4)+Math.ceil(nodes/2);return new Uint32Array(file,0,count).slice()}var uploaded=new Map;function uploadMaterial(gpu,source,entry){let key=String(entry.id),known=uploaded.get(key);if(known)return known;let upload=entry.isotropic?uploadTable(gpu,source,entry):uploadGrid(gpu,source,entry);return uploaded.set(key,upload),upload.catch(()=>uploaded.delete(key)),uploaded.size>4&&forget(gpu,uploaded.keys().next().value),upload}function forget(gpu,key){let upload=uploaded.get(key);uploaded.delete(key),upload?.then(({cells,grid,words})=>{for(let texture of[cells,grid,words])gpu.gl.deleteTexture(texture)})}async function uploadSampler(gpu,source,entry){let material=await uploadMaterial(gpu,source,entry),key=makeKey("runtime",[["material",entry.id]]);if(entry.isotropic&&!material.words&&source.holds(key)){let file=await source.bytes(key).catch(()=>null);file&&!material.words&&(material.words=makeWordTexture(gpu.gl,cutSampler(file),WORDS_ACROSS))}return material}function readRows(words,theta){let floats=new Float32Array(words.buffer,words.byteOffset,words.length),halves=new Uint16Array(words.buffer,words.byteOffset,2*words.length),[tables,rows,segments]=[words[5],words[6],words[7]],fixed=32+tables,weights=fixed+rows+1,cdf=weights+rows+1,density=cdf+Math.ceil(tables*rows/2)+Math.ceil(tables*rows/4),[sine,cosine]=[Math.sin(theta*Math.PI/180),Math.cos(theta*Math.PI/180)],top=.5*(1-cosine/Math.sqrt(2*(1+sine))),second=0;for(;second<tables-1&&floats[32+second]>cosine;)second++;let first=Math.max(second-1,0),[above,below]=[floats[32+first],floats[32+second]],weight=above>below?Math.min(Math.max((above-cosine)/(above-below),0),1):0;function mix(start2,a,b){return halves[2*start2+a]*(1-weight)+halves[2*start2+b]*weight}let edges=[];for(let edge=0;edge<=rows;edge++){let cap=Math.min(Math.max(floats[fixed+edge]+floats[weights+edge]*top,0),1);edges.push(2*Math.asin(Math.sqrt(cap))*180/Math.PI)}let probabilities=[],nodes=[],before=0;for(let row=0;row<rows;row++){let to=mix(cdf,first*rows+row,second*rows+row)/65535;probabilities.push(to-before),before=to;let run=[];for(let node=0;node<=segments;node++){let at=row*(segments+1)+node,table=rows*(segments+1);run.push(mix(density,first*table+at,second*table+at)*2*segments/65534)}nodes.push(run)}return{edges,probabilities,nodes,isFolded:words[8]===1}}var held=new Map;async function loadWords({source,materials}){let[entry]=materials,key=makeKey("runtime",[["material",entry.id]]),words=held.get(key);return words||(words=cutSampler(await source.bytes(key)),held.set(key,words)),words}var rowsPanel={id:"rows",title:"Half-vector table",aspect:.75,depends:["materials","theta"],async draw(frame,view){if(!view.materials[0].table)return"The half-vector table is shown for MERL tables only.";let theta=snapTheta(view),rows=readRows(await loadWords(view),theta),[width,height]=frame.begin(),theme=readTheme(),box={left:52,top:26,width:width-66,height:height-68},last=rows.edges[rows.edges.length-1],x={label:"azimuth of the half vector, fraction of the widest",min:rows.isFolded?0:-1,max:1},y={label:"theta_h, degrees; axis by its square root",min:0,max:last},densities=rows.nodes.map((run,row)=>{let width2=capOf(rows.edges[row+1])-capOf(rows.edges[row]);return run.map(node=>Math.log10(rows.probabilities[row]*node/width2))}),greatest=Math.max(...densities.flat());densities.forEach((run,row)=>{let[high2,low2]=[rows.edges[row+1],rows.edges[row]].map(edge=>box.top+box.height*(1-Math.sqrt(edge/last)));for(let segment=0;segment+1<run.length;segment++){let across=box.width/(run.length-1),gradient=frame.context.createLinearGradient(box.left+segment*across,0,box.left+(segment+1)*across,0);gradient.addColorStop(0,`rgb(${viridis(1+(run[segment]-greatest)/5).join(",")})`),gradient.addColorStop(1,`rgb(${viridis(1+(run[segment+1]-greatest)/5).join(",")})`),frame.context.fillStyle=gradient,frame.context.fillRect(box.left+segment*across,high2,across+.5,low2-high2)}frame.context.fillStyle=theme.paper,frame.context.fillRect(box.left,high2,box.width,.5)}),drawAxes(frame.context,box,x,{...y,isRoot:!0},theme);let likeliest=rows.probabilities.indexOf(Math.max(...rows.probabilities)),[low,high]=[rows.edges[likeliest],rows.edges[likeliest+1]].map(edge=>edge.toPrecision(3));return`${rows.probabilities.length} rows by ${rows.nodes[0].length} nodes of ${view.materials[0].name} (half-vector:64KB) about wo at ${theta}°, by density, 5 decades. The likeliest row, ${low}° to ${high}°, holds ${(100*rows.probabilities[likeliest]).toFixed(1)} % of the draws.`},command({state,materials}){return`merlkit plot ${nameMaterials(materials.slice(0,1))} --kind lobe --theta ${state.theta} --sampler half-vector:64KB`}};function capOf(theta){return Math.sin(theta*Math.PI/360)**2}var STOPS=3;async function loadSlice(view,entry){let{source,state,catalogue}=view;if(entry.isotropic){let table=await loadTable(source,entry),note=table.resampled?` The table of ${entry.name} was resampled at the centres of MERL's bins.`:"";return{read:(h,d,out)=>readCell(table,findCell(table,h,d,state.phiD),out),note}}let phiH=catalogue.stored?findNearest(catalogue.stored.phi_h,state.phiH):state.phiH,phiD=catalogue.stored?findNearest(catalogue.stored.phi_d,state.phiD):state.phiD,{arrays}=await askBinary(source,makeKey("slice",[["material",entry.id],["phi_h",phiH],["phi_d",phiD]]));function read(h,d,out){let at=3*(h*THETA_BINS+d);for(let channel=0;channel<3;channel++)out[channel]=arrays.f[at+channel];return out[0]>=0}return{read,note:` ${entry.name} is anisotropic: values at the centres of MERL's bins, for φh ${phiH}° and φd ${phiD}°.`}}function paintSlice(slices,state){let pixels=new Uint8ClampedArray(4*THETA_BINS*THETA_BINS),[a,b]=[[0,0,0],[0,0,0]],gain=2**state.sliceExposure,isRatio=state.slice==="difference"&&slices.length>1;for(let d=0;d<THETA_BINS;d++)for(let h=0;h<THETA_BINS;h++){let pixel=4*((THETA_BINS-1-d)*THETA_BINS+h),[first,second]=slices;if(!first(h,d,a))continue;let colour=a.map(x=>encodeSrgb(gain*x));if(isRatio){if(!second(h,d,b))continue;colour=diverging(Math.log2(sum(b)/sum(a))/STOPS)}pixels.set([...colour,255],pixel)}return pixels}function sum(rgb){return rgb[0]+rgb[1]+rgb[2]}function findCell(table,h,d,phiD){return(h*THETA_BINS+d)*table.phiBins+Math.min(Math.round(phiD),table.phiBins-1)}function drawImage(frame,box,pixels){let small=document.createElement("canvas");small.width=small.height=THETA_BINS,small.getContext("2d").putImageData(new ImageData(pixels,THETA_BINS,THETA_BINS),0,0),frame.context.imageSmoothingEnabled=!1,frame.context.drawImage(small,box.left,box.top,box.width,box.height)}var slicePanel={id:"slice",title:"Image slice",aspect:1,depends:["materials","phiD","phiH","slice","sliceExposure"],prepare(frame,view){bindSelect(frame,view,"show","slice",["colour","difference"]),bindSlider(frame,view,"phi_d","phiD",{min:0,max:179,step:1,unit:"°"}),bindSlider(frame,view,"phi_h","phiH",{min:0,max:358,step:2,unit:"°"});let turn=frame.controls.lastElementChild;function hideTurn(){turn.hidden=view().materials.every(entry=>entry.isotropic)}frame.syncs.push(hideTurn),hideTurn(),bindSlider(frame,view,"exposure","sliceExposure",{min:-8,max:8,step:.25,unit:" stops"})},async draw(frame,view){let{state,materials}=view,shown=state.slice==="difference"?materials.slice(0,2):materials.slice(0,1),slices=await Promise.all(shown.map(entry=>loadSlice(view,entry))),[width,height]=frame.begin(),side=Math.min(width-62,height-66),box={left:48,top:24,width:side,height:side};frame.context.fillStyle="#8a8a8a",frame.context.fillRect(box.left,box.top,side,side),drawImage(frame,box,paintSlice(slices.map(slice=>slice.read),state));let x={label:"theta_h, bins of (theta_h/90°)^½·90",min:0,max:90};drawAxes(frame.context,box,x,{label:"theta_d, degrees",min:0,max:90},readTheme());let gaps=`Grey has no values.${slices.map(slice=>slice.note).join("")}`;return slices.length>1?`Ratio of ${shown[1].name} to ${shown[0].name}: blue is darker, orange brighter, by up to ${STOPS} stops. ${gaps}`:state.slice==="difference"?`Add a second material to see the difference. ${gaps}`:`${shown[0].name}, tone-mapped as pictures are; an f_r of ${Number((2**-state.sliceExposure).toPrecision(3))} sr⁻¹ is nearly white. ${gaps}`},command({state,materials}){return materials[0]?.isotropic?`merlkit plot ${nameMaterials(materials.slice(0,1))} --kind slice-rgb --phi-d ${state.phiD} --exposure=${state.sliceExposure} -o slice.png`:null}};function findMesh({state,catalogue}){return catalogue.meshes.find(mesh=>mesh.name===state.shape)??null}var uploaded2=null;function uploadMesh(gpu,source,entry){if(uploaded2?.id===entry.id)return uploaded2.mesh;uploaded2?.mesh.then(({array,buffers:buffers2})=>{gpu.gl.deleteVertexArray(array);for(let buffer of buffers2)gpu.gl.deleteBuffer(buffer)},()=>{});let mesh=loadMesh(gpu,source,entry);return uploaded2={id:entry.id,mesh},mesh.catch(()=>uploaded2=null),mesh}async function loadMesh({gl},source,entry){let{members,arrays}=await askBinary(source,makeKey("mesh",[["mesh",entry.id]])),array=gl.createVertexArray();gl.bindVertexArray(array);let buffers2=[];[arrays.positions,arrays.normals].forEach((vectors,place2)=>{let buffer=gl.createBuffer();gl.bindBuffer(gl.ARRAY_BUFFER,buffer),gl.bufferData(gl.ARRAY_BUFFER,vectors,gl.STATIC_DRAW),gl.enableVertexAttribArray(place2),gl.vertexAttribPointer(place2,3,gl.FLOAT,!1,0,0),buffers2.push(buffer)});let indices=gl.createBuffer();gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER,indices),gl.bufferData(gl.ELEMENT_ARRAY_BUFFER,arrays.faces,gl.STATIC_DRAW),gl.bindVertexArray(null);let left=entry.dropped?`, and ${entry.dropped} of no area left out`:"";return{array,buffers:[...buffers2,indices],corners:arrays.faces.length,eye:members.eye,halfHeight:Math.tan(members.vertical_angle/2),note:`${entry.name} (${entry.faces} triangles${left}; it casts no shadow on itself)`}}function drawTriangles({gl},{array,corners}){gl.bindVertexArray(array),gl.drawElements(gl.TRIANGLES,corners,gl.UNSIGNED_INT,0),gl.bindVertexArray(null)}var backdrop_default=`// One more sample of each pixel of what is seen past a mesh. In front of this text is surface.glsl.

uniform vec3 eye;
uniform float half_height;
uniform vec2 shift;

void main()
{
#ifdef LIGHT_IS_SKY
    vec3 back = normalize(eye);
    vec3 up = normalize(cross(back, vec3(1.0, 0.0, 0.0)));
    vec2 place = (2.0 * gl_FragCoord.xy - size) / size.y - shift;
    add_light(sky_along(normalize(-back + half_height * (place.x * vec3(1.0, 0.0, 0.0) + place.y * up))));
#else
    add_light(vec3(0.0));
#endif
}
`;var merlkit_default=`#ifndef MERLKIT_GLSL_INCLUDED
#define MERLKIT_GLSL_INCLUDED 1
// merlkit.glsl: measured materials from files at run time, for GLSL 3.30 and GLSL ES 3.00 and later, written by merlkit 0.1.0
//
//     merlkit_table nickel = merlkit_open(0u);                 // the file that begins at word 0
//     merlkit_draw draw = merlkit_sample(nickel, wo, u1, u2);  // from a point of [0, 1)^2, random or well spread
//     vec3 f = merlkit_eval(nickel, wo, draw.wi);              // estimate: f * draw.wi.z / draw.pdf, 0 where pdf is 0
//     float pdf = merlkit_pdf(nickel, wo, wi);                 // of any direction, for multiple importance sampling
//
// Paste or include this text after #version. The words of the files, one file after the other, are texels of the texture
// merlkit_words: format R32UI, 2048 texels wide, NEAREST. Define MERLKIT_WORD(i) before to have them elsewhere, such as in a
// storage buffer: i is a uint. Files are not checked here; the host does that with merlkit_load of merlkit.h.
//
// Directions leave the surface in a frame whose +z is the normal: wo to the viewer (given), wi to the light (drawn).
// Other lengths than 1 are renormalised. f is f_r, linear RGB in 1/sr without the cosine; pdf is in 1/sr. Both are 0 for what
// is no direction above the horizon. No draw fails for a wo above the horizon. Many draws with one wo are cheaper with
// merlkit_about about = merlkit_prepare(table, wo), then merlkit_draw_prepared(table, about, u1, u2) and
// merlkit_pdf_prepared(table, about, wi).
//
// The code is licensed as merlkit, MIT or Apache-2.0. The numbers in a file are the material's, under the terms of its data.

#ifdef GL_ES
precision highp float;
precision highp int;
#endif
#define MERLKIT_GLSL 1
#define MERLKIT_FN
#define MERLKIT_CONST const
#define MERLKIT_ARRAY(type) type[](
#define MERLKIT_ARRAY_END )
#define MERLKIT_UINT uint
#define MERLKIT_TO_UINT(x) uint(x)
#define MERLKIT_TO_INT(x) int(x)
#define MERLKIT_TO_FLOAT(x) float(x)
#define MERLKIT_SQRT(x) sqrt(x)
#define MERLKIT_ABS(x) abs(x)
#define MERLKIT_VALUES
#define merlkit_vec3 vec3
#define merlkit_v(x, y, z) vec3(x, y, z)

// ---- What functions return ----

// A direction and its density; pdf is 0 where the draw failed.
struct merlkit_draw {
    merlkit_vec3 wi;
    float pdf;
};

// What depends on wo alone: its polar angle, the cosine and sine of its azimuth, the cap of the largest theta_h, and two
// tables with the weight of the second in 1/65536. cos_o is 0 for a wo that is not above the horizon.
struct merlkit_about {
    float sin_o;
    float cos_o;
    float c;
    float s;
    float top;
    MERLKIT_UINT first;
    MERLKIT_UINT second;
    MERLKIT_UINT weight;
};

// Where a direction lies: its cap, its fraction b of the widest azimuth in [-1, 1], and dsigma(wi) per dcap db.
struct merlkit_place {
    float cap;
    float b;
    float jacobian;
};

// Density over the azimuth at both ends of a segment.
struct merlkit_segment {
    float index;
    float low;
    float high;
};

// Half and difference angles in units of MERL's bins, from the lower edge of bin 0.
struct merlkit_bins {
    float theta_h;
    float theta_d;
    float phi_d;
};

// Two neighbouring bins and the weight of the second.
struct merlkit_pair {
    int low;
    int high;
    float weight;
};

// A weighted mean of bins, and the sum of the weights of those that hold a value.
struct merlkit_cell {
    float r;
    float g;
    float b;
    float valid;
};

// ---- Numbers ----

MERLKIT_FN float merlkit_pick(bool condition, float yes, float no)
{
    if (condition) {
        return yes;
    }
    return no;
}

MERLKIT_FN int merlkit_pick_int(bool condition, int yes, int no)
{
    if (condition) {
        return yes;
    }
    return no;
}

MERLKIT_FN float merlkit_min(float a, float b)
{
    return merlkit_pick(a < b, a, b);
}

MERLKIT_FN float merlkit_max(float a, float b)
{
    return merlkit_pick(a > b, a, b);
}

// x in [0, 1), 0 for NaN.
MERLKIT_FN float merlkit_point(float x)
{
    return merlkit_pick(x > 0.0f, merlkit_min(x, 0.99999994f), 0.0f);
}

MERLKIT_FN MERLKIT_UINT merlkit_mix(MERLKIT_UINT a, MERLKIT_UINT b, MERLKIT_UINT weight)
{
    return a * (65536u - weight) + b * weight;
}

// floor(x * 65535 * 65536) of x in [0, 1), exact without f64: x is (a + (b + q) / 65536) / 65536.
MERLKIT_FN MERLKIT_UINT merlkit_row_target(float x)
{
    float scaled = x * 65536.0f;
    MERLKIT_UINT a = MERLKIT_TO_UINT(scaled);
    float r = scaled - MERLKIT_TO_FLOAT(a);
    MERLKIT_UINT b = MERLKIT_TO_UINT(r * 65536.0f);
    float q = r * 65536.0f - MERLKIT_TO_FLOAT(b);
    return a * 65535u + b - MERLKIT_TO_UINT(q < r);
}

// floor(x * 65534 * 65536) of x in [0, 1].
MERLKIT_FN MERLKIT_UINT merlkit_node_target(float x)
{
    float scaled = x * 65536.0f;
    MERLKIT_UINT a = MERLKIT_TO_UINT(scaled);
    float r = scaled - MERLKIT_TO_FLOAT(a);
    MERLKIT_UINT b = MERLKIT_TO_UINT(r * 65536.0f);
    float q = r * 65536.0f - MERLKIT_TO_FLOAT(b);
    return a * 65534u + b - MERLKIT_TO_UINT(q < 2.0f * r) - MERLKIT_TO_UINT(q < 2.0f * r - 1.0f);
}

// ---- Directions ----

// w at unit length: itself where it is so up to rounding. (0, 0, 0) unless it is finite and above the horizon.
MERLKIT_FN merlkit_vec3 merlkit_unit(merlkit_vec3 w)
{
    float length2 = w.x * w.x + w.y * w.y + w.z * w.z;
    float largest = merlkit_max(merlkit_max(MERLKIT_ABS(w.x), MERLKIT_ABS(w.y)), w.z);
    if (w.z > 0.0f && MERLKIT_ABS(length2 - 1.0f) <= 1e-5f) {
        return w;
    }
    if (!(w.z > 0.0f && MERLKIT_ABS(w.x) <= 3.4028234e38f && MERLKIT_ABS(w.y) <= 3.4028234e38f
          && w.z <= 3.4028234e38f)) {
        return merlkit_v(0.0f, 0.0f, 0.0f);
    }
    float x = w.x / largest;
    float y = w.y / largest;
    float z = w.z / largest;
    float scale = 1.0f / MERLKIT_SQRT(x * x + y * y + z * z);
    return merlkit_v(x * scale, y * scale, z * scale);
}

// Step 6: the largest tan(phi/4) that reflects above the horizon.
MERLKIT_FN float merlkit_widest(merlkit_about about, float sin_h, float cos_h)
{
    float sines = 2.0f * sin_h * cos_h * about.sin_o;
    float cosines = (cos_h - sin_h) * (cos_h + sin_h) * about.cos_o;
    float beyond = merlkit_max(sines - cosines, 0.0f);
    float within = merlkit_max(cosines + sines, 1.1754944e-38f);
    return merlkit_max(MERLKIT_SQRT(within) / (MERLKIT_SQRT(beyond) + MERLKIT_SQRT(within + beyond)), 1e-6f);
}

// Steps 1 and 2, of a unit wo above the horizon; the tables are left for step 4.
MERLKIT_FN merlkit_about merlkit_square(merlkit_vec3 wo)
{
    merlkit_about about;
    float rho2 = wo.x * wo.x + wo.y * wo.y;
    float rho = MERLKIT_SQRT(rho2);
    float scale = 1.0f / MERLKIT_SQRT(rho2 + wo.z * wo.z);
    about.c = 1.0f;
    about.s = 0.0f;
    if (rho > 0.0f) {
        float turn = 1.0f / rho;
        about.c = wo.x * turn;
        about.s = wo.y * turn;
    }
    about.sin_o = rho * scale;
    about.cos_o = wo.z * scale;
    about.top = 0.5f * (1.0f - about.cos_o / MERLKIT_SQRT(2.0f * (1.0f + about.sin_o)));
    about.first = 0u;
    about.second = 0u;
    about.weight = 0u;
    return about;
}

// Steps 15 to 17: the direction at a cap and a fraction b of the azimuth.
MERLKIT_FN merlkit_vec3 merlkit_direction(merlkit_about about, float cap, float b)
{
    float sin_h = 2.0f * MERLKIT_SQRT(cap * (1.0f - cap));
    float cos_h = 1.0f - 2.0f * cap;
    float q = b * merlkit_widest(about, sin_h, cos_h);
    float scale = 1.0f / (1.0f + q * q);
    float sin_half = 2.0f * q * scale;
    float cos_half = (1.0f - q * q) * scale;
    float hx = sin_h * ((cos_half - sin_half) * (cos_half + sin_half));
    float hy = sin_h * (2.0f * sin_half * cos_half);
    float twice = 2.0f * (about.sin_o * hx + about.cos_o * cos_h);
    float x = twice * hx - about.sin_o;
    float y = twice * hy;
    float z = twice * cos_h - about.cos_o;
    return merlkit_v(about.c * x - about.s * y, about.s * x + about.c * y, merlkit_max(z, 1e-9f));
}

// Steps 18 to 20, of a unit wi above the horizon.
MERLKIT_FN merlkit_place merlkit_place_of(merlkit_about about, merlkit_vec3 wi)
{
    merlkit_place place;
    float x = about.sin_o + (about.c * wi.x + about.s * wi.y);
    float y = about.c * wi.y - about.s * wi.x;
    float z = about.cos_o + wi.z;
    float rho2 = x * x + y * y;
    float rho = MERLKIT_SQRT(rho2);
    float len = MERLKIT_SQRT(rho2 + z * z);
    float inverse = 1.0f / len;
    float widest = merlkit_widest(about, rho * inverse, z * inverse);
    float sum = rho + MERLKIT_ABS(x);
    float scale = 1.0f / merlkit_max(MERLKIT_SQRT(2.0f * rho * sum), 1.1754944e-38f);
    float big = sum * scale;
    float little = MERLKIT_ABS(y) * scale;
    // Both are at least 0: the azimuth is beyond 90 degrees where x is below 0.
    float over = merlkit_pick(x < 0.0f, big, little);
    float under = merlkit_pick(x < 0.0f, little, big);
    float q = merlkit_min(over / (1.0f + under), 1.0f);
    float b = merlkit_min(q / widest, 1.0f);
    place.cap = 0.5f * rho2 * inverse / (len + z);
    place.b = merlkit_pick(y < 0.0f, -b, b);
    place.jacobian = 16.0f * len * widest / (1.0f + q * q);
    return place;
}

// Step 8: where the probability of a density 1 + slope (2x - 1) passes u.
MERLKIT_FN float merlkit_find_on_slope(float slope, float u)
{
    float start = 1.0f - slope;
    float root = MERLKIT_SQRT(merlkit_max(start * start + 4.0f * slope * u, 0.0f));
    return merlkit_min(2.0f * u / (start + root), 1.0f);
}

// Step 13: where a segment's probability passes rest.
MERLKIT_FN float merlkit_find_in(merlkit_segment segment, float rest)
{
    float low = segment.low;
    float root = MERLKIT_SQRT(merlkit_max(low * low + (segment.high - low) * rest, 0.0f));
    return merlkit_min(rest / (low + root), 1.0f);
}

// ---- MERL's bins ----

// Angle of (x, y), both at least 0, in degrees; 0 for (0, 0) and exact for x = 0. Abramowitz and Stegun 4.4.49: GLSL's own
// arc tangent may be off by a thousand times as much.
MERLKIT_FN float merlkit_degrees(float y, float x)
{
    float high = merlkit_max(x, y);
    float t = 0.0f;
    if (high > 0.0f) {
        t = merlkit_min(x, y) / high;
    }
    float s = t * t;
    float tail = 2.4585398f + s * (-0.9262285f + s * 0.16422264f);
    float a = t * (57.29578f + s * (-19.098485f + s * (11.455461f + s * (-8.1410999f + s * (6.1055895f
                + s * (-4.3137787f + s * tail))))));
    return merlkit_pick(y > x, 90.0f - a, a);
}

// Degrees from 0 to bins of the azimuth of wi, which is phi_d where the half vector is the normal. Opposite azimuths are one
// in a table of 180.
MERLKIT_FN float merlkit_azimuth(merlkit_vec3 wi, int bins)
{
    bool turned = bins == 180 && (wi.y < 0.0f || (wi.y == 0.0f && wi.x < 0.0f));
    float x = merlkit_pick(turned, -wi.x, wi.x);
    float y = merlkit_pick(turned, -wi.y, wi.y);
    float a = merlkit_degrees(MERLKIT_ABS(y), MERLKIT_ABS(x));
    float upper = merlkit_pick(x < 0.0f, 180.0f - a, a);
    return merlkit_pick(y < 0.0f, 360.0f - upper, upper);
}

// Angles of a pair of unit directions above the horizon. Sums and differences of the directions keep their digits where
// products of their components would lose them: f32 is enough.
MERLKIT_FN merlkit_bins merlkit_bins_of(merlkit_vec3 wo, merlkit_vec3 wi, int phi_d_bins)
{
    merlkit_bins at;
    float sx = wo.x + wi.x;
    float sy = wo.y + wi.y;
    float sz = wo.z + wi.z;
    float dx = wo.x - wi.x;
    float dy = wo.y - wi.y;
    float dz = wo.z - wi.z;
    float rho2 = sx * sx + sy * sy;
    float len = MERLKIT_SQRT(rho2 + sz * sz);
    float across = dx * sy - dy * sx;
    float along = dz * len;
    at.theta_h = MERLKIT_SQRT(90.0f * merlkit_degrees(MERLKIT_SQRT(rho2), sz));
    at.theta_d = merlkit_degrees(MERLKIT_SQRT(dx * dx + dy * dy + dz * dz), len);
    if (sx == 0.0f && sy == 0.0f) {
        at.phi_d = merlkit_azimuth(wi, phi_d_bins);
    } else {
        float a = merlkit_degrees(MERLKIT_ABS(across), MERLKIT_ABS(along));
        bool rising = across == 0.0f || ((across > 0.0f) == (dz > 0.0f) && dz != 0.0f);
        bool second = across < 0.0f || (across == 0.0f && dz < 0.0f);
        float half_turn = merlkit_pick(phi_d_bins == 360 && second, 180.0f, 0.0f);
        at.phi_d = merlkit_pick(rising, a, 180.0f - a) + half_turn;
    }
    return at;
}

// The bin that holds x.
MERLKIT_FN int merlkit_bin(float x, int bins)
{
    int bin = MERLKIT_TO_INT(x);
    return merlkit_pick_int(bin < bins, bin, bins - 1);
}

// The bins on both sides of x, held at the ends of the axis.
MERLKIT_FN merlkit_pair merlkit_clamped(float x, int bins)
{
    merlkit_pair pair;
    float held = merlkit_min(merlkit_max(x, 0.0f), MERLKIT_TO_FLOAT(bins - 1));
    pair.low = MERLKIT_TO_INT(held);
    pair.high = merlkit_pick_int(pair.low + 1 < bins, pair.low + 1, pair.low);
    pair.weight = held - MERLKIT_TO_FLOAT(pair.low);
    return pair;
}

// The bins on both sides of x, at least -1, on an axis that closes on itself.
MERLKIT_FN merlkit_pair merlkit_periodic(float x, int bins)
{
    merlkit_pair pair;
    float held = merlkit_pick(x < 0.0f, x + MERLKIT_TO_FLOAT(bins), x);
    int low = MERLKIT_TO_INT(held);
    pair.weight = held - MERLKIT_TO_FLOAT(low);
    pair.low = merlkit_pick_int(low < bins, low, low - bins);
    pair.high = merlkit_pick_int(pair.low + 1 < bins, pair.low + 1, 0);
    return pair;
}

MERLKIT_FN merlkit_cell merlkit_mix_cells(merlkit_cell low, merlkit_cell high, float weight)
{
    merlkit_cell mean;
    mean.r = low.r * (1.0f - weight) + high.r * weight;
    mean.g = low.g * (1.0f - weight) + high.g * weight;
    mean.b = low.b * (1.0f - weight) + high.b * weight;
    mean.valid = low.valid * (1.0f - weight) + high.valid * weight;
    return mean;
}

#ifndef MERLKIT_WORD
uniform highp usampler2D merlkit_words;
#define MERLKIT_WORD(i) merlkit_texel(i)
uint merlkit_texel(uint i)
{
    return texelFetch(merlkit_words, ivec2(int(i % 2048u), int(i / 2048u)), 0).r;
}
#endif
#define MERLKIT_BITS(x) uintBitsToFloat(x)

// ---- The table: docs/export.md of merlkit describes its file ----

// Settings of a table, and the words of its file at which its arrays begin.
struct merlkit_table {
    MERLKIT_UINT tables;
    MERLKIT_UINT rows;
    MERLKIT_UINT segments;
    MERLKIT_UINT fold;
    MERLKIT_UINT rule;
    int phi_bins;
    MERLKIT_UINT cosines;
    MERLKIT_UINT edges_fixed;
    MERLKIT_UINT edges_weight;
    MERLKIT_UINT cdf;
    MERLKIT_UINT slopes;
    MERLKIT_UINT density;
    MERLKIT_UINT values;
    float node_unit;
    float per_segment;
    float offset;
};

// The table of the file that begins at word \`first\`.
MERLKIT_FN merlkit_table merlkit_open(MERLKIT_UINT first)
{
    merlkit_table table;
    table.tables = MERLKIT_WORD(first + 5u);
    table.rows = MERLKIT_WORD(first + 6u);
    table.segments = MERLKIT_WORD(first + 7u);
    table.fold = MERLKIT_WORD(first + 8u);
    table.rule = MERLKIT_WORD(first + 9u);
    table.phi_bins = MERLKIT_TO_INT(MERLKIT_WORD(first + 10u));
    MERLKIT_UINT rows = table.tables * table.rows;
    MERLKIT_UINT nodes = rows * (table.segments + 1u);
    table.cosines = first + 32u;
    table.edges_fixed = table.cosines + table.tables;
    table.edges_weight = table.edges_fixed + table.rows + 1u;
    table.cdf = table.edges_weight + table.rows + 1u;
    table.slopes = table.cdf + ((rows + 1u) >> 1u);
    table.density = table.slopes + ((rows + 3u) >> 2u);
    table.values = table.density + ((nodes + 1u) >> 1u);
    float segments = MERLKIT_TO_FLOAT(table.segments);
    table.node_unit = 0.5f * (2.0f * segments * 2.3283775e-10f);
    table.per_segment = 1.0f / segments;
    table.offset = merlkit_pick(table.rule == 2u, 0.5f, 0.0f);
    return table;
}

MERLKIT_FN float merlkit_table_cosine(merlkit_table table, MERLKIT_UINT i)
{
    return MERLKIT_BITS(MERLKIT_WORD(table.cosines + i));
}

MERLKIT_FN float merlkit_table_edge_fixed(merlkit_table table, MERLKIT_UINT i)
{
    return MERLKIT_BITS(MERLKIT_WORD(table.edges_fixed + i));
}

MERLKIT_FN float merlkit_table_edge_weight(merlkit_table table, MERLKIT_UINT i)
{
    return MERLKIT_BITS(MERLKIT_WORD(table.edges_weight + i));
}

MERLKIT_FN float merlkit_table_value(merlkit_table table, int i)
{
    return MERLKIT_BITS(MERLKIT_WORD(table.values + MERLKIT_TO_UINT(i)));
}

// ---- Drawing: the numbered steps of merlkit's docs/half-vector-table.md ----

// Number i of those of 16 bits from word \`start\` on.
MERLKIT_FN MERLKIT_UINT merlkit_table_u16(merlkit_table table, MERLKIT_UINT start, MERLKIT_UINT i)
{
    return (MERLKIT_WORD(start + (i >> 1u)) >> ((i & 1u) << 4u)) & 0xffffu;
}

// Number i of those of 8 bits from word \`start\` on.
MERLKIT_FN MERLKIT_UINT merlkit_table_u8(merlkit_table table, MERLKIT_UINT start, MERLKIT_UINT i)
{
    return (MERLKIT_WORD(start + (i >> 2u)) >> ((i & 3u) << 3u)) & 0xffu;
}

// Cap at the lower edge of a row.
MERLKIT_FN float merlkit_table_cap(merlkit_table table, merlkit_about about, MERLKIT_UINT row)
{
    return merlkit_table_edge_fixed(table, row) + merlkit_table_edge_weight(table, row) * about.top;
}

// Probability of the rows up to and with this one, in 1/(65535 * 65536).
MERLKIT_FN MERLKIT_UINT merlkit_table_to(merlkit_table table, merlkit_about about, MERLKIT_UINT row)
{
    MERLKIT_UINT a = about.first * table.rows + row;
    MERLKIT_UINT b = about.second * table.rows + row;
    return merlkit_mix(merlkit_table_u16(table, table.cdf, a), merlkit_table_u16(table, table.cdf, b), about.weight);
}

MERLKIT_FN MERLKIT_UINT merlkit_table_below(merlkit_table table, merlkit_about about, MERLKIT_UINT row)
{
    if (row == 0u) {
        return 0u;
    }
    return merlkit_table_to(table, about, row - 1u);
}

MERLKIT_FN float merlkit_table_slope(merlkit_table table, merlkit_about about, MERLKIT_UINT row)
{
    MERLKIT_UINT a = about.first * table.rows + row;
    MERLKIT_UINT b = about.second * table.rows + row;
    // Stored slopes are 128 too large, so their mix is 128 * 65536 too large.
    MERLKIT_UINT mixed = merlkit_mix(merlkit_table_u8(table, table.slopes, a), merlkit_table_u8(table, table.slopes, b), about.weight);
    return MERLKIT_TO_FLOAT(MERLKIT_TO_INT(mixed) - 8388608) * 1.1920929e-7f;
}

MERLKIT_FN MERLKIT_UINT merlkit_table_node(merlkit_table table, merlkit_about about, MERLKIT_UINT row, MERLKIT_UINT node)
{
    MERLKIT_UINT a = (about.first * table.rows + row) * (table.segments + 1u) + node;
    MERLKIT_UINT b = (about.second * table.rows + row) * (table.segments + 1u) + node;
    return merlkit_mix(merlkit_table_u16(table, table.density, a), merlkit_table_u16(table, table.density, b), about.weight);
}

MERLKIT_FN merlkit_segment merlkit_table_segment(merlkit_table table, merlkit_about about, MERLKIT_UINT row, MERLKIT_UINT index)
{
    merlkit_segment segment;
    segment.index = MERLKIT_TO_FLOAT(index);
    segment.low = MERLKIT_TO_FLOAT(merlkit_table_node(table, about, row, index));
    segment.high = MERLKIT_TO_FLOAT(merlkit_table_node(table, about, row, index + 1u));
    return segment;
}

// Steps 1 to 5: what depends on wo alone, for many draws or densities with one wo.
MERLKIT_FN merlkit_about merlkit_prepare(merlkit_table table, merlkit_vec3 wo)
{
    merlkit_vec3 unit = merlkit_unit(wo);
    merlkit_about about = merlkit_square(merlkit_v(0.0f, 0.0f, 1.0f));
    if (!(unit.z > 0.0f)) {
        about.cos_o = 0.0f;
        return about;
    }
    about = merlkit_square(unit);
    MERLKIT_UINT low = 0u;
    MERLKIT_UINT high = table.tables - 1u;
    while (low < high) {
        MERLKIT_UINT middle = (low + high) >> 1u;
        if (merlkit_table_cosine(table, middle) > about.cos_o) {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    about.second = low;
    about.first = low;
    if (low > 0u) {
        about.first = low - 1u;
    }
    float above = merlkit_table_cosine(table, about.first);
    float below = merlkit_table_cosine(table, about.second);
    if (above > below) {
        float weight = merlkit_min(merlkit_max((above - about.cos_o) / (above - below), 0.0f), 1.0f);
        about.weight = MERLKIT_TO_UINT(weight * 65536.0f + 0.5f);
    }
    return about;
}

// Steps 18 to 22: merlkit_pdf for the wo that \`about\` was made of.
MERLKIT_FN float merlkit_pdf_prepared(merlkit_table table, merlkit_about about, merlkit_vec3 wi)
{
    merlkit_vec3 unit = merlkit_unit(wi);
    if (!(about.cos_o > 0.0f && unit.z > 0.0f)) {
        return 0.0f;
    }
    merlkit_place place = merlkit_place_of(about, unit);
    MERLKIT_UINT row = 0u;
    MERLKIT_UINT end = table.rows;
    while (row + 1u < end) {
        MERLKIT_UINT middle = (row + end) >> 1u;
        if (merlkit_table_cap(table, about, middle) <= place.cap) {
            row = middle;
        } else {
            end = middle;
        }
    }
    float low = merlkit_table_cap(table, about, row);
    float width = merlkit_table_cap(table, about, row + 1u) - low;
    float y = 0.5f * (place.b + 1.0f);
    if (table.fold == 1u) {
        y = MERLKIT_ABS(place.b);
    }
    float at = y * MERLKIT_TO_FLOAT(table.segments);
    MERLKIT_UINT index = MERLKIT_TO_UINT(at);
    if (index >= table.segments) {
        index = table.segments - 1u;
    }
    merlkit_segment segment = merlkit_table_segment(table, about, row, index);
    float x = merlkit_min(merlkit_max((place.cap - low) / width, 0.0f), 1.0f);
    float along = MERLKIT_TO_FLOAT(merlkit_table_to(table, about, row) - merlkit_table_below(table, about, row)) * 2.328342e-10f
            * (1.0f + merlkit_table_slope(table, about, row) * (2.0f * x - 1.0f));
    float across = segment.low + (segment.high - segment.low) * (at - segment.index);
    return merlkit_min(along * across * table.node_unit / (width * place.jacobian), 3.4028234e38f);
}

// Steps 7 to 17: merlkit_sample for the wo that \`about\` was made of.
MERLKIT_FN merlkit_draw merlkit_draw_prepared(merlkit_table table, merlkit_about about, float u1, float u2)
{
    merlkit_draw draw;
    draw.wi = merlkit_v(0.0f, 0.0f, 0.0f);
    draw.pdf = 0.0f;
    if (!(about.cos_o > 0.0f)) {
        return draw;
    }
    float v = merlkit_point(u2);
    float side = 2.0f * v - 1.0f;
    if (table.fold == 1u) {
        v = MERLKIT_ABS(side);
    }
    MERLKIT_UINT goal = merlkit_row_target(merlkit_point(u1));
    MERLKIT_UINT row = 0u;
    MERLKIT_UINT last = table.rows - 1u;
    while (row < last) {
        MERLKIT_UINT middle = (row + last) >> 1u;
        if (merlkit_table_to(table, about, middle) <= goal) {
            row = middle + 1u;
        } else {
            last = middle;
        }
    }
    MERLKIT_UINT below = merlkit_table_below(table, about, row);
    float fraction = MERLKIT_TO_FLOAT(goal - below) / MERLKIT_TO_FLOAT(merlkit_table_to(table, about, row) - below);
    float low = merlkit_table_cap(table, about, row);
    float cap = merlkit_find_on_slope(merlkit_table_slope(table, about, row), merlkit_min(fraction, 1.0f));
    cap = low + (merlkit_table_cap(table, about, row + 1u) - low) * cap;
    goal = merlkit_node_target(v);
    below = 0u;
    MERLKIT_UINT sum = 0u;
    MERLKIT_UINT index = 0u;
    MERLKIT_UINT node = merlkit_table_node(table, about, row, 0u);
    while (index + 1u < table.segments) {
        MERLKIT_UINT next = merlkit_table_node(table, about, row, index + 1u);
        sum += node + next;
        if (sum > goal) {
            break;
        }
        node = next;
        below = sum;
        index += 1u;
    }
    merlkit_segment segment = merlkit_table_segment(table, about, row, index);
    float b = (segment.index + merlkit_find_in(segment, MERLKIT_TO_FLOAT(goal - below))) * table.per_segment;
    if (table.fold == 1u) {
        b = merlkit_pick(side < 0.0f, -b, b);
    } else {
        b = 2.0f * b - 1.0f;
    }
    draw.wi = merlkit_direction(about, cap, merlkit_min(merlkit_max(b, -1.0f), 1.0f));
    draw.pdf = merlkit_pdf_prepared(table, about, draw.wi);
    return draw;
}

// A direction wi for wo, from a point of [0, 1)^2; pdf 0 where wo is not above the horizon, and never otherwise.
MERLKIT_FN merlkit_draw merlkit_sample(merlkit_table table, merlkit_vec3 wo, float u1, float u2)
{
    return merlkit_draw_prepared(table, merlkit_prepare(table, wo), u1, u2);
}

// Density of drawing wi for wo, per solid angle; 0 unless both are above the horizon.
MERLKIT_FN float merlkit_pdf(merlkit_table table, merlkit_vec3 wo, merlkit_vec3 wi)
{
    return merlkit_pdf_prepared(table, merlkit_prepare(table, wo), wi);
}

// f_r by the bin that holds the angles, as MERL's own reader: 1/sr, without the cosine; 0 unless both directions are above
// the horizon, and where nothing was measured.
MERLKIT_FN merlkit_vec3 merlkit_eval_floor(merlkit_table table, merlkit_vec3 wo, merlkit_vec3 wi)
{
    merlkit_vec3 o = merlkit_unit(wo);
    merlkit_vec3 i = merlkit_unit(wi);
    if (!(o.z > 0.0f && i.z > 0.0f)) {
        return merlkit_v(0.0f, 0.0f, 0.0f);
    }
    merlkit_bins at = merlkit_bins_of(o, i, table.phi_bins);
    int cell = merlkit_bin(at.theta_d, 90) + 90 * merlkit_bin(at.theta_h, 90);
    cell = 3 * (merlkit_bin(at.phi_d, table.phi_bins) + table.phi_bins * cell);
    return merlkit_v(merlkit_max(merlkit_table_value(table, cell), 0.0f), merlkit_max(merlkit_table_value(table, cell + 1), 0.0f),
                     merlkit_max(merlkit_table_value(table, cell + 2), 0.0f));
}

// A bin's value and the weight 1 where it holds one, zeros elsewhere.
MERLKIT_FN merlkit_cell merlkit_table_bin(merlkit_table table, int theta_h, int theta_d, int phi_d)
{
    merlkit_cell cell;
    int at = 3 * (phi_d + table.phi_bins * (theta_d + 90 * theta_h));
    bool valid = merlkit_table_value(table, at) >= 0.0f;
    cell.r = merlkit_pick(valid, merlkit_table_value(table, at), 0.0f);
    cell.g = merlkit_pick(valid, merlkit_table_value(table, at + 1), 0.0f);
    cell.b = merlkit_pick(valid, merlkit_table_value(table, at + 2), 0.0f);
    cell.valid = merlkit_pick(valid, 1.0f, 0.0f);
    return cell;
}

MERLKIT_FN merlkit_cell merlkit_table_row(merlkit_table table, int theta_h, int theta_d, merlkit_pair phi_d)
{
    return merlkit_mix_cells(merlkit_table_bin(table, theta_h, theta_d, phi_d.low),
                             merlkit_table_bin(table, theta_h, theta_d, phi_d.high), phi_d.weight);
}

MERLKIT_FN merlkit_cell merlkit_table_plane(merlkit_table table, int theta_h, merlkit_pair theta_d, merlkit_pair phi_d)
{
    return merlkit_mix_cells(merlkit_table_row(table, theta_h, theta_d.low, phi_d),
                             merlkit_table_row(table, theta_h, theta_d.high, phi_d), theta_d.weight);
}

// f_r, linear between bins; those where nothing was measured are left out. 1/sr, without the cosine; 0 unless both
// directions are above the horizon, and where no bin around them holds a value.
MERLKIT_FN merlkit_vec3 merlkit_eval_linear(merlkit_table table, merlkit_vec3 wo, merlkit_vec3 wi)
{
    merlkit_vec3 o = merlkit_unit(wo);
    merlkit_vec3 i = merlkit_unit(wi);
    if (!(o.z > 0.0f && i.z > 0.0f)) {
        return merlkit_v(0.0f, 0.0f, 0.0f);
    }
    merlkit_bins at = merlkit_bins_of(o, i, table.phi_bins);
    merlkit_pair theta_h = merlkit_clamped(at.theta_h - table.offset, 90);
    merlkit_pair theta_d = merlkit_clamped(at.theta_d - table.offset, 90);
    merlkit_pair phi_d = merlkit_periodic(at.phi_d - table.offset, table.phi_bins);
    merlkit_cell mean = merlkit_mix_cells(merlkit_table_plane(table, theta_h.low, theta_d, phi_d),
                                          merlkit_table_plane(table, theta_h.high, theta_d, phi_d), theta_h.weight);
    if (!(mean.valid > 0.0f)) {
        return merlkit_v(0.0f, 0.0f, 0.0f);
    }
    return merlkit_v(merlkit_min(mean.r / mean.valid, 3.4028234e38f), merlkit_min(mean.g / mean.valid, 3.4028234e38f),
                     merlkit_min(mean.b / mean.valid, 3.4028234e38f));
}

// f_r of wo and wi in 1/sr by the table's lookup rule, without the cosine; 0 unless both are above the horizon, and where
// nothing was measured.
MERLKIT_FN merlkit_vec3 merlkit_eval(merlkit_table table, merlkit_vec3 wo, merlkit_vec3 wi)
{
    if (table.rule == 0u) {
        return merlkit_eval_floor(table, wo, wi);
    }
    return merlkit_eval_linear(table, wo, wi);
}
#endif
`;var mesh_fragment_default=`// One more sample of each pixel that a mesh covers. It is seen from both sides, and hides no light from itself.
// In front of this text is surface.glsl.

in vec3 at;
in vec3 bent;
uniform vec3 eye;
uniform bool is_smooth;

void main()
{
    // Step 1: the normal of the triangle, on the side of the eye.
    vec3 wo = normalize(eye - at);
    vec3 normal = normalize(cross(dFdx(at), dFdy(at)));
    normal = dot(normal, wo) < 0.0 ? -normal : normal;
    // Step 2: that of its corners, where it is on the same side and faces the eye.
    vec3 smooth_normal = length(bent) > 1e-6 ? normalize(bent) : normal;
    smooth_normal = dot(smooth_normal, normal) < 0.0 ? -smooth_normal : smooth_normal;
    if (is_smooth && dot(smooth_normal, wo) > 0.0) {
        outside = normal;
        normal = smooth_normal;
    }
    mat3 frame = make_frame(normal);
    add_light(reflect_light(wo * frame, frame));
}
`;var mesh_vertex_default=`#version 300 es
// A corner of a mesh, whose surrounding sphere is the unit sphere about the origin.
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
uniform vec3 eye;
uniform float half_height;
uniform vec2 shift;
out vec3 at;
out vec3 bent;

void main()
{
    at = position;
    bent = normal;
    vec3 back = normalize(eye);
    vec3 up = normalize(cross(back, vec3(1.0, 0.0, 0.0)));
    vec3 seen = position - eye;
    float ahead = -dot(seen, back);
    // Nothing is nearer or farther than the sphere.
    float near = length(eye) - 1.01;
    float far = length(eye) + 1.01;
    float depth = ((far + near) * ahead - 2.0 * far * near) / (far - near);
    vec2 place = vec2(seen.x, dot(seen, up)) / half_height;
    gl_Position = vec4(place + shift * ahead, depth, ahead);
}
`;var sphere_default=`// One more sample of each pixel: a unit sphere. In front of this text is surface.glsl.

// The camera of merlkit render for one sphere, which has the radius 1 and rests on y = 0.
const vec3 CENTRE = vec3(0.0, 1.0, 0.0);
const vec3 TARGET = vec3(0.0, 0.95, 0.0);
const float HALF_HEIGHT = 0.21255656;

vec3 trace(vec3 eye, vec3 direction)
{
    // Step 1: the foot of the perpendicular from the centre, and half of the chord.
    float along = dot(CENTRE - eye, direction);
    vec3 perpendicular = CENTRE - eye - along * direction;
    float chord2 = 1.0 - dot(perpendicular, perpendicular);
    if (chord2 < 0.0) {
#ifdef LIGHT_IS_SKY
        return sky_along(direction);
#else
        return vec3(0.0);
#endif
    }
    // Step 2: the normal at the near end, and wo in the frame there.
    vec3 normal = normalize(-perpendicular - sqrt(chord2) * direction);
    mat3 frame = make_frame(normal);
    return reflect_light(-direction * frame, frame);
}

void main()
{
    vec3 back = normalize(vec3(0.0, 0.22, 1.0));
    vec3 eye = TARGET + back * (1.12 * 1.1 / HALF_HEIGHT + 1.0);
    vec3 up = normalize(cross(back, vec3(1.0, 0.0, 0.0)));
    // The first sample is at the pixel's centre, so that a moving picture does not tremble.
    vec2 jitter = count == 0u ? vec2(0.5) : vec2(draw_point(0u), draw_point(1u));
    vec2 place = (2.0 * (floor(gl_FragCoord.xy) + jitter) - size) / size.y;
    add_light(trace(eye, normalize(-back + HALF_HEIGHT * (place.x * vec3(1.0, 0.0, 0.0) + place.y * up))));
}
`;var surface_default=`// How a surface reflects and what lights it, for one more sample of each pixel.
//
// In front of this text are #version, merlkit.glsl, LIGHT_IS_SKY for an environment, and VALUES_ARE_GRID for values over four angles.

#ifdef VALUES_ARE_GRID
uniform highp sampler3D grid;
#else
uniform highp usampler2D cells;
uniform float unit;
uniform int phi_bins;
#endif
uniform highp sampler2D before;
uniform vec2 size;
uniform uint count;
#ifdef LIGHT_IS_SKY
uniform highp sampler2D sky;
#ifndef VALUES_ARE_GRID
uniform bool has_table;
#endif
#else
uniform vec3 towards;
#endif
out vec4 mean;

const float PI = 3.14159265;
// The normal of the triangle where another one reflects: what is below it finds the mesh itself.
vec3 outside = vec3(0.0);

#ifdef VALUES_ARE_GRID
// Nodes of the grid over theta_h, phi_h, theta_d and phi_d.
const int THETA_H_NODES = 64;
const float PHI_H_NODES = 64.0;
const int THETA_D_NODES = 20;
const int PHI_D_NODES = 24;
// How many blocks over theta_h lie side by side in the texture, and so many times as many over theta_d behind one another.
const int BLOCKS_ACROSS = 4;

// Logarithms at a node of phi_d, between the nodes of the other angles, by the texture's filter.
vec3 read_block(int node, vec3 place)
{
    vec3 block = vec3(0.0, node % BLOCKS_ACROSS * THETA_H_NODES, node / BLOCKS_ACROSS * THETA_D_NODES);
    vec3 size = vec3(PHI_H_NODES, BLOCKS_ACROSS * THETA_H_NODES, PHI_D_NODES / BLOCKS_ACROSS * THETA_D_NODES);
    return texture(grid, (block + place + 0.5) / size).rgb;
}

// f_r between the nodes of the grid, linear in its logarithm.
vec3 look_up(vec3 wo, vec3 wi)
{
    vec3 o = merlkit_unit(wo);
    vec3 i = merlkit_unit(wi);
    if (!(o.z > 0.0 && i.z > 0.0)) {
        return vec3(0.0);
    }
    // Step 1: the angles, as HalfDiff of the library. About the normal phi_h is undefined, and phi_d is the azimuth of wi.
    vec3 sum = o + i;
    float rho = length(sum.xy);
    bool is_pole = rho < 1e-5;
    float theta_h = atan(rho, sum.z);
    float phi_h = is_pole ? 0.0 : atan(sum.y, sum.x);
    float theta_d = atan(length(o - i), length(sum));
    float phi_d = is_pole ? atan(i.y, i.x) : atan(o.x * i.y - o.y * i.x, 0.5 * (o.z - i.z) * length(sum));
    // Step 2: positions among the nodes. The texture repeats over phi_h.
    vec3 place;
    place.x = phi_h / (2.0 * PI) * PHI_H_NODES;
    place.y = min(sqrt(theta_h / (0.5 * PI)), 1.0) * float(THETA_H_NODES - 1);
    place.z = min(theta_d / (0.5 * PI), 1.0) * float(THETA_D_NODES - 1);
    float turn = fract(phi_d / (2.0 * PI)) * float(PHI_D_NODES);
    int low = min(int(turn), PHI_D_NODES - 1);
    // Step 3: the two nodes of phi_d.
    vec3 below = read_block(low, place);
    vec3 above = read_block((low + 1) % PHI_D_NODES, place);
    return exp2(mix(below, above, turn - float(low)));
}
#else
// f_r by the bin that holds the angles, as the library's floor lookup.
vec3 look_up(vec3 wo, vec3 wi)
{
    vec3 o = merlkit_unit(wo);
    vec3 i = merlkit_unit(wi);
    if (!(o.z > 0.0 && i.z > 0.0)) {
        return vec3(0.0);
    }
    merlkit_bins bins = merlkit_bins_of(o, i, phi_bins);
    int cell = merlkit_bin(bins.theta_d, 90) + 90 * merlkit_bin(bins.theta_h, 90);
    cell = merlkit_bin(bins.phi_d, phi_bins) + phi_bins * cell;
    uint word = texelFetch(cells, ivec2(cell % 1620, cell / 1620), 0).r;
    if (word == 0xf8000000u) {
        return vec3(0.0);
    }
    float scale = unit * uintBitsToFloat(((word >> 27) + 127u) << 23);
    return scale * vec3(float(word & 511u), float((word >> 9) & 511u), float((word >> 18) & 511u));
}
#endif

// A number of 32 bits that depends on every bit of x (Jarzynski and Olano 2020).
uint mix_bits(uint x)
{
    uint state = x * 747796405u + 2891336453u;
    uint word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}

// Coordinate \`axis\` of point \`count\` of a lattice in four dimensions, shifted at random for each pixel.
float draw_point(uint axis)
{
    const uint STEPS[4] = uint[4](3679390609u, 3152041523u, 2700274806u, 2313257605u);
    uint pixel = uint(gl_FragCoord.x) + 8192u * uint(gl_FragCoord.y);
    return float((mix_bits(4u * pixel + axis) + count * STEPS[axis]) >> 8) * (1.0 / 16777216.0);
}

#ifdef LIGHT_IS_SKY
// Radiance from a direction: rows from +y to -y, the middle is -z, the right half is +x; bilinear between centres.
vec3 sky_along(vec3 w)
{
    ivec2 extent = textureSize(sky, 0);
    vec2 place = vec2(atan(w.x, -w.z) / (2.0 * PI) + 0.5, acos(clamp(w.y, -1.0, 1.0)) / PI);
    vec2 from = place * vec2(extent) - 0.5;
    ivec2 low = ivec2(floor(from));
    vec2 t = from - vec2(low);
    int left = (low.x + extent.x) % extent.x;
    int right = (low.x + 1) % extent.x;
    int upper = max(low.y, 0);
    int lower = min(low.y + 1, extent.y - 1);
    vec3 above = mix(texelFetch(sky, ivec2(left, upper), 0).rgb, texelFetch(sky, ivec2(right, upper), 0).rgb, t.x);
    vec3 below = mix(texelFetch(sky, ivec2(left, lower), 0).rgb, texelFetch(sky, ivec2(right, lower), 0).rgb, t.x);
    return mix(above, below, t.y);
}

// One path: a direction by the half-vector table or by the cosine, and f cos L / pdf.
vec3 reflect_light(vec3 wo, mat3 frame)
{
    float u1 = draw_point(2u);
    float u2 = draw_point(3u);
    float rho = sqrt(u1);
    merlkit_draw draw;
    draw.wi = vec3(rho * cos(2.0 * PI * u2), rho * sin(2.0 * PI * u2), sqrt(1.0 - u1));
    draw.pdf = draw.wi.z / PI;
#ifndef VALUES_ARE_GRID
    if (has_table) {
        draw = merlkit_sample(merlkit_open(0u), wo, u1, u2);
    }
#endif
    if (!(draw.pdf > 0.0) || dot(outside, frame * draw.wi) < 0.0) {
        return vec3(0.0);
    }
    return look_up(wo, draw.wi) * (draw.wi.z / draw.pdf) * sky_along(frame * draw.wi);
}
#else
// Parallel light of irradiance pi on a surface that faces it.
vec3 reflect_light(vec3 wo, mat3 frame)
{
    if (dot(outside, towards) < 0.0) {
        return vec3(0.0);
    }
    vec3 wi = towards * frame;
    return look_up(wo, wi) * (PI * max(wi.z, 0.0));
}
#endif

// A frame whose x runs along the circle about the vertical.
mat3 make_frame(vec3 normal)
{
    vec3 along = vec3(normal.z, 0.0, -normal.x);
    float length2 = dot(along, along);
    vec3 x = length2 < 1e-12 ? vec3(1.0, 0.0, 0.0) : along * inversesqrt(length2);
    return mat3(x, cross(normal, x), normal);
}

// Takes light into the mean of the pixel's samples.
void add_light(vec3 light)
{
    vec3 past = texelFetch(before, ivec2(gl_FragCoord.xy), 0).rgb;
    mean = vec4(count == 0u ? light : mix(past, light, 1.0 / float(count + 1u)), 1.0);
}
`;var tone_default=`#version 300 es
// Linear light on its way to the screen, as the library's PNG pictures: exposure, tone curve, sRGB.
precision highp float;
uniform highp sampler2D light;
uniform float gain;
uniform vec2 scale;
out vec4 colour;

float tone(float x)
{
    return x > 0.5 ? 1.0 - 0.5 * exp(1.0 - 2.0 * x) : max(x, 0.0);
}

float encode(float x)
{
    return x <= 0.0031308 ? 12.92 * x : 1.055 * pow(x, 1.0 / 2.4) - 0.055;
}

void main()
{
    vec3 x = gain * texelFetch(light, ivec2(gl_FragCoord.xy * scale), 0).rgb;
    colour = vec4(encode(tone(x.r)), encode(tone(x.g)), encode(tone(x.b)), 1.0);
}
`;var ENOUGH={parallel:32,sky:1024},SLOW=50,COARSE={parallel:1,sky:64},PAUSE=50,begun2=new Map,programs=new Map,skies=new Map,sums=[],current=null,latest2=0,milliseconds=1/0,TEXTS={sphere:[COVER,sphere_default],backdrop:[COVER,backdrop_default],mesh:[mesh_vertex_default,mesh_fragment_default]};function begin(gpu,name,vertex,fragment){begun2.has(name)||begun2.set(name,beginProgram(gpu.gl,vertex,fragment))}function finish(gpu,name){let program3=programs.get(name)??finishProgram(gpu.gl,begun2.get(name));return programs.set(name,program3),program3}function beginPart(gpu,part,isSky,isGrid){let name=`${part} ${isSky} ${isGrid}`,defines=`${isSky?`#define LIGHT_IS_SKY
`:""}${isGrid?`#define VALUES_ARE_GRID
`:""}`,[vertex,fragment]=TEXTS[part];return begin(gpu,name,vertex,`#version 300 es
${defines}precision highp sampler3D;
${merlkit_default}${surface_default}${fragment}`),name}function getProgram(gpu,part,isSky,isGrid){return finish(gpu,beginPart(gpu,part,isSky,isGrid))}function getTone(gpu){return begin(gpu,"tone",COVER,tone_default),finish(gpu,"tone")}function prepareSpheres(gpu,state){beginPart(gpu,"sphere",state.light!=="directional",!1),begin(gpu,"tone",COVER,tone_default)}function loadSky(gpu,source,name){let sky=skies.get(name);if(!sky){let{gl}=gpu;sky=askBinary(source,makeKey("environment",[["name",name]])).then(({members,arrays})=>{let[{shape}]=members.arrays;return makeTexture(gl,[shape[1],shape[0]],[gl.RGB32F,gl.RGB,gl.FLOAT],arrays.radiance)}),skies.set(name,sky),sky.catch(()=>skies.delete(name))}return sky}function getSums(gpu,number,size){let{gl}=gpu;if(sums[number]?.size===size)return sums[number];for(let texture of sums[number]?.textures??[])gl.deleteTexture(texture);for(let frame of sums[number]?.frames??[])gl.deleteFramebuffer(frame);gl.deleteRenderbuffer(sums[number]?.depth??null);let depth=gl.createRenderbuffer();gl.bindRenderbuffer(gl.RENDERBUFFER,depth),gl.renderbufferStorage(gl.RENDERBUFFER,gl.DEPTH_COMPONENT24,size,size);let made=[0,1].map(()=>{let texture=makeTexture(gl,[size,size],[gpu.sums,gl.RGBA,gpu.sums===gl.RGBA16F?gl.HALF_FLOAT:gl.FLOAT],null),frame=gl.createFramebuffer();return gl.bindFramebuffer(gl.FRAMEBUFFER,frame),gl.framebufferTexture2D(gl.FRAMEBUFFER,gl.COLOR_ATTACHMENT0,gl.TEXTURE_2D,texture,0),gl.framebufferRenderbuffer(gl.FRAMEBUFFER,gl.DEPTH_ATTACHMENT,gl.RENDERBUFFER,depth),{texture,frame}});return sums[number]={size,textures:[made[0].texture,made[1].texture],frames:[made[0].frame,made[1].frame],depth,latest:0},sums[number]}function addSample(gpu,run,number,state){let{gl}=gpu,{size,frames,latest:from}=run.sums[number];if(gl.bindFramebuffer(gl.FRAMEBUFFER,frames[1-from]),gl.viewport(0,0,size,size),gl.disable(gl.DEPTH_TEST),!run.mesh)useProgram(gpu,run,number,state,"sphere"),gl.drawArrays(gl.TRIANGLES,0,3);else{useProgram(gpu,run,number,state,"backdrop"),gl.drawArrays(gl.TRIANGLES,0,3);let{uniforms}=useProgram(gpu,run,number,state,"mesh");gl.uniform1i(uniforms.is_smooth,state.normals==="smooth"?1:0),gl.enable(gl.DEPTH_TEST),gl.clear(gl.DEPTH_BUFFER_BIT),drawTriangles(gpu,run.mesh),gl.disable(gl.DEPTH_TEST)}run.sums[number].latest=1-from}var STEPS=[.7548776662,.5698402909];function useProgram(gpu,run,number,state,part){let{gl}=gpu,{size,textures,latest:from}=run.sums[number],{cells,grid,words,unit,phiBins}=run.materials[number],program3=getProgram(gpu,part,run.sky!==null,grid!==null),{uniforms}=program3;if(gl.useProgram(program3.program),bindTextures(gl,program3,{cells,grid,merlkit_words:words??cells,before:textures[from],sky:run.sky}),gl.uniform1f(uniforms.unit??null,unit),gl.uniform1i(uniforms.phi_bins??null,phiBins),gl.uniform2f(uniforms.size??null,size,size),gl.uniform1ui(uniforms.count??null,run.count),gl.uniform1i(uniforms.has_table??null,words?1:0),gl.uniform3f(uniforms.towards??null,...aimLight(state.lightTheta,state.lightPhi)),run.mesh){gl.uniform3f(uniforms.eye??null,...run.mesh.eye),gl.uniform1f(uniforms.half_height??null,run.mesh.halfHeight);let[x,y]=STEPS.map(step=>(1-2*((.5+run.count*step)%1))/size);gl.uniform2f(uniforms.shift??null,x,y)}return program3}function aimLight(theta,phi){let[t,p]=[theta*Math.PI/180,phi*Math.PI/180];return[Math.sin(t)*Math.sin(p),Math.cos(t),Math.sin(t)*Math.cos(p)]}function showSums(gpu,run,number,gain,pixels){let{gl}=gpu,{size,textures,latest:from}=run.sums[number],program3=getTone(gpu);beginPicture(gpu,pixels,pixels),gl.useProgram(program3.program),bindTextures(gl,program3,{light:textures[from]}),gl.uniform1f(program3.uniforms.gain,gain),gl.uniform2f(program3.uniforms.scale,size/pixels,size/pixels),gl.disable(gl.DEPTH_TEST),gl.drawArrays(gl.TRIANGLES,0,3)}function nameRun({state,materials},side){let light=state.light==="directional"?[state.lightTheta,state.lightPhi]:[state.light];return[side,state.shape,state.normals,...light,...materials.map(entry=>entry.id)].join(" ")}async function drawSpheres(frame,view){let{gpu,source,state,materials}=view;if(!gpu||gpu.sums===null)return"This browser has no WebGL 2 with float targets, so spheres are not drawn.";frame.aspect=1/Math.max(materials.length,1),frame.begin();let side=Math.floor(frame.canvas.width/Math.max(materials.length,1)),name=nameRun(view,side);if(current?.name!==name){let sky=state.light==="directional"?null:await loadSky(gpu,source,state.light),entry=findMesh(view),mesh=entry?await uploadMesh(gpu,source,entry):null,upload=sky?uploadSampler:uploadMaterial,uploads=await Promise.all(materials.map(entry2=>upload(gpu,source,entry2))),pixels=milliseconds>SLOW?side>>1:side;current={name,materials:uploads,sums:uploads.map((_,i)=>getSums(gpu,i,pixels)),sky,mesh,count:0}}else current.count>0&&showRun(frame,view,current,side);let run=current;return latest2+=1,refine(frame,view,run,latest2,side),frame.section.querySelector(".caption").textContent}function showRun(frame,view,run,side){for(let i=0;i<run.materials.length;i++)showSums(view.gpu,run,i,2**view.state.exposure,side),frame.context.setTransform(1,0,0,1,0,0),copyPicture(view.gpu,[side,side],frame.context,[i*side,frame.canvas.height-side,side,side])}function refine(frame,view,run,number,side){let gpu=view.gpu,enough=run.sky?ENOUGH.sky:ENOUGH.parallel;function step(){if(number!==latest2||run.count>=enough||(setTimeout(()=>requestAnimationFrame(step),milliseconds>SLOW?PAUSE:0),!frame.isSeen))return;run.count===(run.sky?COARSE.sky:COARSE.parallel)&&run.sums.some(s=>s.size!==side)&&(run.sums=run.materials.map((_,i)=>getSums(gpu,i,side)),run.count=0);let begun3=performance.now();for(let i=0;i<run.materials.length;i++)addSample(gpu,run,i,view.state);run.count+=1,showRun(frame,view,run,side),run.sums[0].size===side&&(milliseconds=performance.now()-begun3),describeRun(frame,view,run,enough)}requestAnimationFrame(step)}function describeRun(frame,{state,materials},run,enough){let light=run.sky?`under ${state.light}, ${run.count} paths a pixel`:`under parallel light from ${state.lightTheta.toFixed(0)}°, ${state.lightPhi.toFixed(0)}° with irradiance π, ${run.count} samples a pixel`,speed=run.count<enough&&run.count>1?`, ${(1e3/milliseconds).toFixed(0)} frames/s`:"";frame.canvas.dataset.samples=String(run.count);let shape=run.mesh?` on ${run.mesh.note}`:"",notes=run.materials.map(material=>material.note).join("");setCaption(frame,`${materials.map(m=>m.name).join(", ")}${shape} ${light}${speed}.${notes}`,!1)}function addShapes(frame,view){bindSelect(frame,view,"shape","shape",["sphere",...view().catalogue.meshes.map(mesh=>mesh.name)]),bindSelect(frame,view,"normals","normals",["flat","smooth"]);let normals=frame.controls.lastElementChild;function hideNormals(state){normals.hidden=state.shape==="sphere"}frame.syncs.push(hideNormals),hideNormals(view().state)}var spherePanel={id:"sphere",title:"Spheres",aspect:1,depends:["materials","shape","normals","light","lightTheta","lightPhi","exposure"],prepare(frame,view){addShapes(frame,view),bindSelect(frame,view,"light","light",["directional",...view().catalogue.environments]),bindSlider(frame,view,"exposure","exposure",{min:-6,max:6,step:.25,unit:" stops"}),onDrag(frame.canvas,"Drag, or use the arrow keys, to move the light",(dx,dy)=>{let{state,change}=view(),{lightTheta,lightPhi}=state;change({light:"directional",lightTheta:Math.min(Math.max(Math.round(lightTheta+dy/2),0),180),lightPhi:Math.round((lightPhi+dx/2+540)%360-180)})})},draw:drawSpheres,command(view){let{state,materials}=view,light=state.light==="directional"?`directional:${state.lightTheta},${state.lightPhi}`:state.light,background=state.light==="directional"?" --background black":"",exposure=state.exposure?` --exposure=${state.exposure}`:"",options=`--light ${quoteWord(light)}${background} --bounces 1${exposure}`,mesh=findMesh(view);return mesh?nameMeshScene(mesh,materials[0],state.normals,options):`merlkit render ${nameMaterials(materials)} ${options} --size ${512*materials.length}x512 -o sphere`}};var PANELS=[spherePanel,lobePanel,polarPanel,cartesianPanel,slicePanel,drawsPanel,discPanel,rowsPanel,environmentPanel],PATIENCE=400;function say(message){document.getElementById("status").textContent=message}async function start(){let source=openSource(),asking=askJson(source,makeKey("materials",[])),gpu=openGpu(),begun3=readFragment(location.hash);askFirst(source,begun3),gpu&&(prepareSpheres(gpu,begun3),prepareLobes(gpu));let catalogue=await asking,view=makeView(source,catalogue,gpu);await resolveAll(view),askTables(view);let shown=[],main=document.querySelector("main");for(let panel of PANELS)shown.push({panel,frame:makeFrame(panel,main,()=>view),isStale:!0,isDrawing:!1});let bar=document.getElementById("direction"),syncs=addDirection(bar,view),area=document.getElementById("materials");showMaterials(area,()=>view,say);let isFileHidden=source.isStored;document.getElementById("load").hidden=isFileHidden,document.getElementById("version").textContent=`merlkit ${catalogue.version}`;let queued=!1;function queue(){queued||(queued=!0,requestAnimationFrame(()=>{queued=!1;for(let item of shown)drawIfSeen(item,view)}))}function makeStale(keys){for(let item of shown){item.panel.depends.some(key=>keys.includes(key))&&(item.isStale=!0);for(let sync of item.frame.syncs)sync(view.state)}for(let sync of syncs)sync(view.state);queue()}view.change=(patch,keepControls=!1)=>{let keys=Object.keys(patch).filter(key=>patch[key]!==view.state[key]);if(keys.length){if(Object.assign(view.state,patch),rememberState(view.state),!keys.includes("materials"))return makeStale(keys);resolveAll(view).then(()=>{keepControls||showMaterials(area,()=>view,say),makeStale(keys)})}},acceptFiles(()=>view,say),watchScreen(shown,queue),window.addEventListener("hashchange",()=>{location.hash!==addressOf(view.state)&&view.change(withDefault(readFragment(location.hash),catalogue))}),queue()}function askFirst(source,state){state.materials.length||source.isStored||askLobe(source,0,state.theta,0).catch(()=>{})}function askTables({source,gpu,materials}){if(gpu)for(let entry of materials)entry.isotropic&&loadTable(source,entry).catch(()=>{})}function makeView(source,catalogue,gpu){return{state:withDefault(readFragment(location.hash),catalogue),materials:[],catalogue,source,gpu,change:()=>{}}}function withDefault(state,catalogue){return!state.materials.length&&catalogue.materials.length&&(state.materials=[catalogue.materials[0].name]),catalogue.environments.includes(state.map)||(state.map=catalogue.environments[0]??DEFAULTS.map),["directional",...catalogue.environments].includes(state.light)||(state.light=DEFAULTS.light),["sphere",...catalogue.meshes.map(mesh=>mesh.name)].includes(state.shape)||(state.shape=catalogue.meshes[0]?.name??"sphere"),state}async function resolveAll(view){let texts=view.state.materials,entries=[];for(let text of texts)try{entries.push(await resolveMaterial(view.source,view.catalogue,text))}catch(error){say(`${text}: ${error.message}`)}texts===view.state.materials&&(view.materials=entries,entries.length&&(view.state.materials=entries.map(entry=>entry.name)))}var remembering=0;function addressOf(state){let token=readToken();return`#${[token&&`token=${token}`,writeFragment(state)].filter(Boolean).join("&")}`}function rememberState(state){clearTimeout(remembering),remembering=window.setTimeout(()=>history.replaceState(null,"",addressOf(state)),250)}function addDirection(bar,view){let theta=addSlider(bar,"wo: theta",{min:0,max:89,step:1,unit:"°"},view.state.theta,x=>view.change({theta:x})),phi=addSlider(bar,"phi",{min:0,max:358,step:2,unit:"°"},view.state.phi,x=>view.change({phi:x})),note=addElement(bar,"span",{class:"note"});return view.catalogue.stored&&(note.textContent=`Exported page: angles go to the nearest of ${view.catalogue.stored.thetas.join("°, ")}°.`),[state=>theta(state.theta),state=>phi(state.phi)]}async function drawIfSeen(item,view){let{panel,frame}=item;if(!(item.isDrawing||!item.isStale||!frame.isSeen)){for(item.isDrawing=!0;item.isStale&&frame.isSeen;){item.isStale=!1;let waiting=setTimeout(()=>setCaption(frame,"Computing…",!1),PATIENCE);try{let caption=await panel.draw(frame,view);caption&&setCaption(frame,caption,!1),frame.canvas.setAttribute("aria-label",`${panel.title}. ${caption}`),frame.section.dataset.drawn=String(Number(frame.section.dataset.drawn??0)+1)}catch(error){frame.begin(),setCaption(frame,error.message,!0)}finally{clearTimeout(waiting)}}item.isDrawing=!1}}function watchScreen(shown,queue){let items=new Map(shown.map(item=>[item.frame.section,item])),sight=new IntersectionObserver(entries=>{for(let entry of entries)items.get(entry.target).frame.isSeen=entry.isIntersecting;queue()},{rootMargin:"100px"});for(let{frame}of shown)sight.observe(frame.section);function redraw(){for(let item of shown)item.isStale=!0;queue()}let width=innerWidth;window.addEventListener("resize",()=>{width!==innerWidth&&redraw(),width=innerWidth}),matchMedia("(prefers-color-scheme: dark)").addEventListener("change",redraw)}start().catch(error=>say(error.message));})();
